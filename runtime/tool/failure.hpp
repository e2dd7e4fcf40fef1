// The end of a program that read a scene and failed.
#pragma once

namespace cdot {

// Prints the exception that is being handled: the mistakes of a scene with their number, any other after the program's
// name. Returns the exit status. Call it in a catch block of main().
int report_failure(const char* program);

}  // namespace cdot
