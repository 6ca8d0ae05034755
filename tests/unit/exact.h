// Closed forms computed from their definitions with 50 decimal digits and rounded to double. Tests compare with them.
#pragma once

namespace brume::exact {

double erf(double x);
double erfc(double x);
double erfcx(double x);                           // e^(x^2) erfc(x)
double erfDifference(double a, double h);         // erf(a + h) - erf(a)
double phi(double x);                             // (1 - e^-x) / x
double opacity(double x);                         // 1 - e^-x
double depthOfOpacity(double y);                  // -log(1 - y)
double henyeyGreenstein(double cosine, double g); // 1/sr, cosine between the directions of travel

} // namespace brume::exact
