# cdot_describe_tool(tool summary command...): builds the completions of a program for shells, and manual pages of the
# program and of its commands, which need help2man. `man cdot-run simulate` opens cdot-run-simulate.1.
find_program(HELP2MAN help2man)

function(cdot_describe_tool tool summary)
  set(folder ${PROJECT_BINARY_DIR}/share)
  set(bash ${folder}/bash-completion/completions/${tool})
  set(zsh ${folder}/zsh/site-functions/_${tool})
  file(MAKE_DIRECTORY ${folder}/bash-completion/completions ${folder}/zsh/site-functions ${folder}/man/man1)
  add_custom_command(OUTPUT ${bash} ${zsh} DEPENDS ${tool} VERBATIM
    COMMAND ${tool} completion bash > ${bash}
    COMMAND ${tool} completion zsh > ${zsh})
  set(files ${bash} ${zsh})
  if(HELP2MAN)
    set(make ${HELP2MAN} --no-info --manual=Cdot --version-string)
    set(page ${folder}/man/man1/${tool}.1)
    add_custom_command(OUTPUT ${page} DEPENDS ${tool} VERBATIM
      COMMAND ${make} "${tool} ${PROJECT_VERSION}" --name=${summary} -o ${page} $<TARGET_FILE:${tool}>)
    list(APPEND files ${page})
    foreach(command ${ARGN})
      set(page ${folder}/man/man1/${tool}-${command}.1)
      add_custom_command(OUTPUT ${page} DEPENDS ${tool} VERBATIM
        COMMAND ${make} "${tool}-${command} ${PROJECT_VERSION}" "--name=the command ${command} of ${tool}"
          "--help-option=${command} --help" -o ${page} $<TARGET_FILE:${tool}>)
      list(APPEND files ${page})
    endforeach()
  endif()
  add_custom_target(${tool}_share ALL DEPENDS ${files})
endfunction()
