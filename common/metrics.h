// Error metrics between a picture and its reference. Every metric is defined here, so that all reports mean the same
// by a name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <glm/glm.hpp>

#include "common/image.h"

namespace brume {

struct WorstPixel {
    int x = -1, y = -1; // counted from the top left
    double error = 0;   // |v - r| / (r + 0.01) in the worst channel
    glm::vec3 value{0}, reference{0};
};

// v is the value, r >= 0 the reference, both linear radiance. Sums go over the compared pixels and their three
// channels. Metrics marked "bright" use only channels where r exceeds 1e-3 of the largest compared r; they are NaN if
// there is none (a black reference). psnr, ssim and flip compare displayed pictures: exposed, tone mapped, in [0, 1],
// not rounded to 8 bits.
struct Errors {
    double relative_rmse = 0; // bright: sqrt(sum (v - r)^2 / sum r^2)
    double bias = 0;          // bright: mean (v - r) / r; positive is too bright
    double rel_mse = 0;       // mean (v - r)^2 / (r + 0.01)^2
    double psnr = 0;          // dB, of sRGB values, peak 1; infinite for equal pictures
    double ssim = 1;          // mean, of luma (common/metrics_ssim.h); NaN if no window fits the picture
    double flip = 0;          // mean, LDR-FLIP (common/metrics_flip.h)
    WorstPixel worst;         // the largest term of rel_mse
    size_t pixels = 0;        // number of compared pixels
    // Pixels with NaN or infinity in radiance or transmittance, in both pictures, inside and outside the mask.
    size_t not_finite = 0;

    // False: a number was not finite, or the mask left no pixel. Then all errors are NaN, so that no comparison with
    // a bound is true, and `worst` is the first pixel that is not finite.
    bool comparable() const { return pixels > 0 && not_finite == 0; }
};

// `mask`: empty for all pixels, or width * height values, 0 for pixels that are left out. Windows and filters (ssim,
// flip) of a pixel in the mask still use neighbours outside it. Throws std::invalid_argument if sizes differ.
Errors compare(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display,
               std::span<const uint8_t> mask = {});

// All errors in one line. It begins with a warning if pixels were not finite or nothing was compared.
std::string describe(const Errors& errors);

// Measures flicker and popping: mean FLIP between consecutive frames, minus that of the reference's frames. Positive:
// pictures change more than the reference; negative: less (a picture that lags). NaN if a frame has a pixel that is
// not finite. Throws std::invalid_argument for fewer than two frames, lists of different length, or different sizes.
double temporalFlip(std::span<const RadianceImage> frames, std::span<const RadianceImage> reference_frames,
                    const DisplaySettings& display);

} // namespace brume
