// Functions that libm has, of exactly rounded operations only: libm's last bits differ between its versions, these give
// equal bits on all machines. What the state is made of uses no others.
#pragma once

namespace brume {

// -log(1 - x), within 3e-16 of it, relative. Precondition: 0 <= x < 1.
double depthOf(double x);

// Cube root, within 2e-16 of it, relative. Precondition: x is 0 or a normal number above.
double cubeRoot(double x);

// e^x, within 4e-16 of it, relative. x is brought into [-700, 700]; of NaN it is NaN.
double exponential(double x);

// Sine and cosine of x (rad), within 1e-15. Precondition: |x| < 1e6.
double sine(double x);
double cosine(double x);

} // namespace brume
