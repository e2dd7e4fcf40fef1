// All blocks of one planar and one spatial joint, compiled for each pack alone, as in a user's program.
#include "tests/kernels/erase_block.hpp"

namespace cdot {

template <class T>
const std::vector<AnyBlock>& some_blocks() {
  static const std::vector<AnyBlock> all = [] {
    std::vector<AnyBlock> list;
    add_joint<Plane, planar::line, T>(list);
    add_joint<Space, spatial::universal, T>(list);
    return list;
  }();
  return all;
}

template const std::vector<AnyBlock>& some_blocks<Pack<float, 4>>();
template const std::vector<AnyBlock>& some_blocks<Pack<float, 8>>();
template const std::vector<AnyBlock>& some_blocks<Pack<float, 16>>();
template const std::vector<AnyBlock>& some_blocks<Pack<double, 4>>();
template const std::vector<AnyBlock>& some_blocks<Pack<double, 8>>();
template const std::vector<AnyBlock>& some_blocks<Pack<double, 16>>();

}  // namespace cdot
