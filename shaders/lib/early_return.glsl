// Which intervals method isv leaves out as too thin (seed 000 section 3.11). Include after `tick` is declared.
layout(constant_id = kIdEarlyReturn) const uint kEarlyReturn = kReturnSum;

const float kFixedReturn = 1e-3; // optical depth, in the program of seed 000

// The least optical depth of an interval that is drawn. kReturnSum: the cut bounds the sum over all particles.
float leastDepth() { return kEarlyReturn == kReturnSum ? tick.cut : kEarlyReturn == kReturnFixed ? kFixedReturn : 0; }
