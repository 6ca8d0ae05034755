// MotionErrors: how pictures in motion err beside the true ones, frame by frame.
#pragma once

#include <span>
#include <vector>

#include "common/image.h"

namespace brume::bench {

// v_i is the luminance of a frame's pixel, r_i the reference's, e_i = v_i - r_i. Sums go over the frames, and over
// pixels that show the medium and are no edges in all frames of the term. All are 0, and `ratio` 1, of the reference
// against itself.
struct MotionErrors {
    std::vector<double> rmse;       // relative RMSE of each frame, as MediumError::medium has it
    double mean = 0, deviation = 0; // of `rmse`: sum / n, and sqrt(sum (rmse - mean)^2 / n)
    size_t greatest = 0;            // the frame with the largest
    // sqrt(sum (e_{i-2} - 2 e_{i-1} + e_i)^2 / sum r_i^2). A steady error does not count, nor one that grows steadily;
    // one that moves with what is seen does.
    double flicker = 0;
    double temporal_flip = 0; // temporalFlip(): changes from frame to frame beyond the reference's, of all pixels
    // In frames: l of the least squares v'_i = g r'_i + l (r'_{i-1} - r'_i), over g, where x'_i = x_i - x_{i-1}, so
    // that a steady error takes no part. A picture that is a mean of past frames lags by their mean age while motion is
    // smooth. NaN where the reference stands still.
    double lag = 0;
    // Part of sum (v'_i - r'_i)^2, without what g explains, that the term with l explains: 1 for a ghost alone. Lag
    // means little where this is near 0.
    double ghost = 0;
    // The least and the greatest (sum v_i / sum r_i) / (sum v_{i-1} / sum r_{i-1}): the whole picture's brightness.
    struct {
        double least = 1, greatest = 1;
    } ratio;
};

// Precondition: at least three frames, as many of the reference. Throws std::invalid_argument if sizes differ.
MotionErrors motionErrors(std::span<const RadianceImage> seen, std::span<const RadianceImage> reference,
                          const DisplaySettings& display);

// Sum / n, and the root of the mean squared distance from it. NaN without values.
struct Spread {
    double mean, deviation;
};
Spread spreadOf(std::span<const double> values);

} // namespace brume::bench
