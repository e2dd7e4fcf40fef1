// What a long run shares with the process around it: the CPU's clock, and whether somebody asked it to stop.
#pragma once

namespace cdot {

double cpu_now();  // spent by this thread [s]

// While one lives, Ctrl-C does not end the process but is noted. They do not nest.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  static bool asked();  // since the last one was made

 private:
  void (*previous_)(int);
};

}  // namespace cdot
