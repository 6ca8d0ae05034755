// The closed forms at 50 decimal digits, straight from their definitions, rounded to double: what the tests compare against.
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
