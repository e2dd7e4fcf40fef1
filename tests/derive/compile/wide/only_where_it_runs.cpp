// The tests of this program use AVX-512, which not every machine has: there it ends before any of them, with success.
#include <cstdio>
#include <cstdlib>

namespace {

[[gnu::constructor(101)]] void end_without_avx512() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
    return;
  std::puts("not tested: this machine has no AVX-512");
  std::exit(0);
}

}  // namespace
