// How far a picture is from its reference. Every number is named by its definition, so that no report compares two different
// things.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <glm/glm.hpp>

#include "common/image.h"

namespace brume {

struct WorstPixel {
    int x = -1, y = -1; // from the top left
    double error = 0;   // |v - r| / (r + 0.01) of its worst channel
    glm::vec3 value{0}, reference{0};
};

// v is the value, r >= 0 the reference, both linear radiance; sums go over the compared pixels and their three channels. Those of
// `bright` take only channels where r exceeds 1e-3 of the largest r compared; they are NaN where there is none (a black
// reference). Psnr, ssim and flip see what a viewer sees: exposed, tone mapped, in [0, 1], not rounded to 8 bits.
struct Errors {
    double relative_rmse = 0; // bright: sqrt(sum (v - r)^2 / sum r^2)
    double bias = 0;          // bright: mean (v - r) / r; positive is too bright
    double rel_mse = 0;       // mean (v - r)^2 / (r + 0.01)^2
    double psnr = 0;          // dB, sRGB values, peak 1; infinite when equal
    double ssim = 1;          // mean, of luma (common/metrics_ssim.h); NaN where no window fits the picture
    double flip = 0;          // mean, LDR-FLIP (common/metrics_flip.h)
    WorstPixel worst;         // the largest term of rel_mse
    size_t pixels = 0;        // compared
    // Pixels of either whole picture, in the mask or not, with NaN or infinity in radiance or transmittance.
    size_t not_finite = 0;

    // False: something was not finite, or the mask left nothing. Then all errors are NaN, so that no bound on them holds, and
    // `worst` is the first pixel that is not finite.
    bool comparable() const { return pixels > 0 && not_finite == 0; }
};

// `mask`: empty for all pixels, or width * height values, 0 for pixels that are left out. Windows and filters (ssim, flip) of a
// pixel within still see its neighbours without. Throws std::invalid_argument when sizes differ.
Errors compare(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display,
               std::span<const uint8_t> mask = {});

// One line with all of them; it says first when pixels were not finite or nothing was compared.
std::string describe(const Errors& errors);

// Flicker and popping: the mean FLIP between consecutive frames minus the same of the reference's frames. Positive: more changes
// than should; negative: less (a picture that lags). NaN when a frame holds a pixel that is not finite. Throws
// std::invalid_argument for fewer than two frames, lists of different length, or sizes that differ.
double temporalFlip(std::span<const RadianceImage> frames, std::span<const RadianceImage> reference_frames,
                    const DisplaySettings& display);

} // namespace brume
