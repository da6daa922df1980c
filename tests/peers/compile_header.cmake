# Compiles a converted header as firmware would and compares its torques with those of the states, some 100 of the file's rows.
# AT: columns of q, qd, qdd and the torque of the first drive, and from there to the next drive's.
cmake_minimum_required(VERSION 3.25)

file(MAKE_DIRECTORY ${WORK})
file(STRINGS ${HEADER} spaces REGEX "^namespace [a-z0-9_]+ {$")
string(REGEX REPLACE "namespace ([a-z0-9_]+) {" "\\1" space "${spaces}")
file(READ ${STATES} text)
string(REGEX MATCHALL "[^\n]+" lines "${text}")
list(POP_FRONT lines)
list(LENGTH lines count)
math(EXPR step "${count} / 100 + 1")
math(EXPR last "${count} - 1")
foreach(k RANGE 0 ${last} ${step})
  list(GET lines ${k} line)
  string(APPEND rows "{${line}},\n")
endforeach()
file(WRITE ${WORK}/main.cpp "#include \"${HEADER}\"

#include <cstdio>

namespace {
constexpr int kDrives = ${DRIVES}, kAt[] = {${AT}};
const double kRows[][64] = {${rows}};

template <class T>
bool agrees(double tolerance) {
  auto model = ${space}::feed_forward<T>();
  double worst = static_cast<double>(${space}::self_check<T>());
  if (worst < 0) return false;
  double largest = 0;
  for (const auto& row : kRows) {
    deltadyn::Vector<T, kDrives> q, qd, qdd, tau;
    for (int i = 0; i < kDrives; ++i) {
      const int drive = kAt[4] * i;
      q(i) = static_cast<T>(row[kAt[0] + drive]);
      qd(i) = static_cast<T>(row[kAt[1] + drive]);
      qdd(i) = static_cast<T>(row[kAt[2] + drive]);
    }
    if (model.from_drives(q, qd, qdd, tau) != deltadyn::Status::ok) return false;
    for (int i = 0; i < kDrives; ++i) {
      const double expected = row[kAt[3] + kAt[4] * i], error = static_cast<double>(tau(i)) - expected, size = error < 0 ? -error : error;
      if (!(size <= worst)) worst = size;
      if (expected > largest || -expected > largest) largest = expected < 0 ? -expected : expected;
    }
  }
  std::printf(\"largest difference %g of %g N m or N\\n\", worst, largest);
  return worst < tolerance * largest && largest > 0.1;
}
}  // namespace

int main() {
  return agrees<double>(1e-12) && agrees<float>(1e-5) ? 0 : 1;
}
")
set(command ${COMPILER} -std=c++17 -O1 -DEIGEN_NO_IO -fno-exceptions -fno-rtti -Wall -Wextra -Wpedantic -Wconversion -Wshadow
  -Wdouble-promotion -Werror -I${INCLUDE})
foreach(folder IN LISTS SYSTEM_INCLUDE)
  list(APPEND command -isystem ${folder})
endforeach()
execute_process(COMMAND ${command} ${WORK}/main.cpp -o ${WORK}/main COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/main COMMAND_ERROR_IS_FATAL ANY)
