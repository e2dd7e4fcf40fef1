# cdot_add_joints(TARGET name SPECS file.joint...): a target that links cdot::runtime gets joints of its own. At build
# time `cdot derive` proves the specs and writes their kernels below the target's build folder, where
# #include <cdot/planar/NAME.hpp> finds them; a file added to the target makes the runtime know them by name.
# A spec may include the shipped ones and those beside it.
function(cdot_add_joints)
  cmake_parse_arguments(arg "" "TARGET" "SPECS" ${ARGN})
  if(NOT arg_TARGET OR NOT arg_SPECS OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "usage: cdot_add_joints(TARGET name SPECS file.joint...)")
  endif()
  if(NOT TARGET cdot::cdot)
    message(FATAL_ERROR "cdot_add_joints: this cdot was built without its generator (CDOT_DERIVE=OFF)")
  endif()
  set(out ${CMAKE_CURRENT_BINARY_DIR}/cdot_joints/${arg_TARGET})
  set(specs "")
  set(kernels ${out}/cdot/coordinate/registry.hpp ${out}/cdot/planar/registry.hpp ${out}/cdot/spatial/registry.hpp)
  foreach(spec ${arg_SPECS})
    cmake_path(ABSOLUTE_PATH spec BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    list(APPEND specs ${spec})
    file(STRINGS ${spec} header REGEX "^(joint|effect) +[^ ]+ +(planar|spatial|coordinate|joint)" LIMIT_COUNT 1)
    if(header MATCHES "^(joint|effect) +([^ ]+) +(planar|spatial|coordinate|joint)")
      string(REPLACE joint coordinate space ${CMAKE_MATCH_3})
      list(APPEND kernels ${out}/cdot/${space}/${CMAKE_MATCH_2}.hpp)
    endif()
  endforeach()
  # `cdot derive` leaves alone what is right already, so the ledger's time alone says when it last ran.
  add_custom_command(OUTPUT ${out}/cdot/ledger.csv BYPRODUCTS ${kernels}
    COMMAND cdot::cdot derive --specs ${CDOT_SPECS} -o ${out}/cdot ${specs}
    COMMAND ${CMAKE_COMMAND} -E touch ${out}/cdot/ledger.csv
    DEPENDS cdot::cdot ${specs} COMMENT "Deriving the joints of ${arg_TARGET}" VERBATIM)
  file(CONFIGURE OUTPUT ${out}/add_joints.cpp CONTENT [=[
// Written by cdot_add_joints. Makes the joints of this target known to the runtime before main().
#include <cdot/coordinate/registry.hpp>
#include <cdot/planar/registry.hpp>
#include <cdot/spatial/registry.hpp>
#include <cdot/detail/add_joints.hpp>

namespace {
[[maybe_unused]] const bool added = [] {
  cdot::add_effects_on_any_coordinate(std::type_identity<cdot::coordinate::Effects>{});
  cdot::add_joints<cdot::Planar>(std::type_identity<cdot::planar::Joints>{});
  cdot::add_joints<cdot::Planar>(std::type_identity<cdot::planar::Effects>{});
  cdot::add_joints<cdot::Spatial>(std::type_identity<cdot::spatial::Joints>{});
  cdot::add_joints<cdot::Spatial>(std::type_identity<cdot::spatial::Effects>{});
  return true;
}();
}  // namespace
]=] @ONLY)
  target_sources(${arg_TARGET} PRIVATE ${out}/add_joints.cpp ${out}/cdot/ledger.csv)
  set_source_files_properties(${out}/add_joints.cpp PROPERTIES OBJECT_DEPENDS ${out}/cdot/ledger.csv)
  target_include_directories(${arg_TARGET} BEFORE PRIVATE ${out})
endfunction()

# cdot_use_joints(TARGET name PLANAR revolute... SPATIAL hinge...): the program knows these shipped joints alone, and is
# smaller by all others. Joints of its own may be added beside them.
function(cdot_use_joints)
  cmake_parse_arguments(arg "" "TARGET" "PLANAR;SPATIAL" ${ARGN})
  if(NOT arg_TARGET OR NOT (arg_PLANAR OR arg_SPATIAL) OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "usage: cdot_use_joints(TARGET name [PLANAR joint...] [SPATIAL joint...])")
  endif()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/cdot_joints/${arg_TARGET}/use_joints.cpp)
  set(text "// Written by cdot_use_joints.\n#include <cdot/detail/use_joints.hpp>\n")
  foreach(space planar spatial)
    string(TOUPPER ${space} choice)
    set(list "")
    foreach(joint ${arg_${choice}})
      string(APPEND text "#include <cdot/${space}/${joint}.hpp>\n")
      string(APPEND list ", cdot::${space}::${joint}")
    endforeach()
    string(REGEX REPLACE "^, " "" list "${list}")
    set(${space} "using ${space}_joints = std::tuple<${list}>;\n")
  endforeach()
  file(CONFIGURE OUTPUT ${source} CONTENT "${text}\n${planar}${spatial}CDOT_USE_JOINTS(planar_joints, spatial_joints)\n")
  target_sources(${arg_TARGET} PRIVATE ${source})
endfunction()
