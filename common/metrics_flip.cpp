#include "common/metrics_flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

namespace brume {

namespace {

// --- filters: every one is a product of a row and a column, or a sum of two such
// ------------------------------------------------

using Plane = std::vector<float>;
using Kernel = std::vector<float>; // odd; the middle is at 0

struct Size {
    int width, height;
};

// Beyond the picture its outermost pixels go on.
Plane alongRows(const Plane& in, Size size, const Kernel& kernel) {
    const int radius = static_cast<int>(kernel.size()) / 2;
    Plane out(in.size(), 0.0f), row(size.width + 2 * radius);
    for (int y = 0; y < size.height; ++y) {
        const float* from = &in[size_t(y) * size.width];
        for (int x = 0; x < size.width + 2 * radius; ++x) row[x] = from[std::clamp(x - radius, 0, size.width - 1)];
        float* to = &out[size_t(y) * size.width];
        for (size_t tap = 0; tap < kernel.size(); ++tap)
            for (int x = 0; x < size.width; ++x) to[x] += kernel[tap] * row[x + tap];
    }
    return out;
}

Plane alongColumns(const Plane& in, Size size, const Kernel& kernel) {
    const int radius = static_cast<int>(kernel.size()) / 2;
    Plane out(in.size(), 0.0f);
    for (int y = 0; y < size.height; ++y) {
        float* to = &out[size_t(y) * size.width];
        for (int tap = -radius; tap <= radius; ++tap) {
            const float weight = kernel[tap + radius];
            const float* from = &in[size_t(std::clamp(y + tap, 0, size.height - 1)) * size.width];
            for (int x = 0; x < size.width; ++x) to[x] += weight * from[x];
        }
    }
    return out;
}

Plane filtered(const Plane& in, Size size, const Kernel& row, const Kernel& column) {
    return alongColumns(alongRows(in, size, row), size, column);
}

// f at -radius ... radius, with positive weights that sum to 1 and negative ones that sum to -1 (or none).
template <class F>
Kernel kernelOf(int radius, F f) {
    std::vector<double> values;
    double positive = 0, negative = 0;
    for (int i = -radius; i <= radius; ++i) {
        values.push_back(f(double(i)));
        (values.back() > 0 ? positive : negative) += std::abs(values.back());
    }
    Kernel out;
    for (const double v : values) out.push_back(static_cast<float>(v > 0 ? v / positive : v < 0 ? v / negative : 0));
    return out;
}

// --- colour: what is left of it after the eye's contrast sensitivity
// --------------------------------------------------------------

// CIE XYZ over that of white, from linear Rec. 709 with D65 (x 0.3127, y 0.3290): white is (1, 1, 1) in both.
glm::dmat3 xyzFromRgb() {
    glm::dmat3 columns(glm::dvec3(10135552.0 / 24577794, 2613072.0 / 12288897, 1425312.0 / 73733382),
                       glm::dvec3(8788810.0 / 24577794, 8788810.0 / 12288897, 8788810.0 / 73733382),
                       glm::dvec3(4435075.0 / 24577794, 887015.0 / 12288897, 70074185.0 / 73733382));
    const glm::dvec3 white = columns[0] + columns[1] + columns[2];
    for (int c = 0; c < 3; ++c) columns[c] /= white;
    return columns;
}

// CIELAB with a and b scaled by the lightness over 100: the Hunt effect, dark colours look less colourful.
glm::vec3 huntLab(glm::vec3 xyz) {
    constexpr float kLinear = 6.0f / 29; // cubed: below this the cube root goes on as a line
    for (int c = 0; c < 3; ++c)
        xyz[c] =
            xyz[c] > kLinear * kLinear * kLinear ? std::cbrt(xyz[c]) : xyz[c] / (3 * kLinear * kLinear) + 4.0f / 29;
    const float lightness = 116 * xyz.y - 16;
    return {lightness, 0.01f * lightness * 500 * (xyz.x - xyz.y), 0.01f * lightness * 200 * (xyz.y - xyz.z)};
}

float hyab(glm::vec3 a, glm::vec3 b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

// A sensitivity is a sum of Gaussians a sqrt(pi / b) e^(-pi^2 d^2 / b), d in degrees, the whole normalised to 1.
struct Sensitivity {
    struct Term {
        float share;
        Kernel kernel;
    };
    std::vector<Term> terms;
};
struct Bell {
    double a, b; // b in square degrees
};
constexpr Bell kAchromatic{1, 0.0047}, kRedGreen{1, 0.0053};
constexpr std::array<Bell, 2> kBlueYellow{{{34.1, 0.04}, {13.5, 0.025}}};

Sensitivity sensitivity(std::span<const Bell> bells, double pixels_per_degree) {
    constexpr double kPi2 = std::numbers::pi * std::numbers::pi;
    // Three standard deviations of the widest bell, for all of them.
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(kBlueYellow[0].b / (2 * kPi2)) * pixels_per_degree));
    Sensitivity out;
    double whole = 0;
    for (const Bell& bell : bells) {
        const auto value = [&](double i) {
            return std::exp(-kPi2 * i * i / (bell.b * pixels_per_degree * pixels_per_degree));
        };
        double sum = 0;
        for (int i = -radius; i <= radius; ++i) sum += value(i);
        const double volume = bell.a * std::sqrt(std::numbers::pi / bell.b) * sum * sum;
        out.terms.push_back({static_cast<float>(volume), kernelOf(radius, value)});
        whole += volume;
    }
    for (Sensitivity::Term& term : out.terms) term.share = static_cast<float>(term.share / whole);
    return out;
}

Plane filtered(const Plane& in, Size size, const Sensitivity& by) {
    Plane out(in.size(), 0.0f);
    for (const Sensitivity::Term& term : by.terms) {
        const Plane part = filtered(in, size, term.kernel, term.kernel);
        for (size_t i = 0; i < out.size(); ++i) out[i] += term.share * part[i];
    }
    return out;
}

// --- one picture, as FLIP compares it
// ---------------------------------------------------------------------------------------------

struct Seen {
    std::vector<glm::vec3> colour; // Hunt-adjusted CIELAB
    Plane edge, point; // strengths of the luminance's first and second differences, Gaussians of half 0.082 degrees
};

// Opponent colours Y, X - Y and Y - Z take the sensitivities; the paper's offsets and factors drop out of filters that
// sum to 1.
std::vector<glm::vec3> seenColour(std::span<const glm::vec3> xyz, Size size, double pixels_per_degree) {
    Plane y, red_green, blue_yellow;
    for (const glm::vec3& v : xyz) {
        y.push_back(v.y);
        red_green.push_back(v.x - v.y);
        blue_yellow.push_back(v.y - v.z);
    }
    y = filtered(y, size, sensitivity({&kAchromatic, 1}, pixels_per_degree));
    red_green = filtered(red_green, size, sensitivity({&kRedGreen, 1}, pixels_per_degree));
    blue_yellow = filtered(blue_yellow, size, sensitivity(kBlueYellow, pixels_per_degree));
    const glm::mat3 xyz_from_rgb(xyzFromRgb()), rgb_from_xyz(glm::inverse(xyzFromRgb()));
    std::vector<glm::vec3> out;
    for (size_t i = 0; i < y.size(); ++i) {
        const glm::vec3 rgb = rgb_from_xyz * glm::vec3(y[i] + red_green[i], y[i], y[i] - blue_yellow[i]);
        out.push_back(huntLab(xyz_from_rgb * glm::clamp(rgb, 0.0f, 1.0f)));
    }
    return out;
}

Plane strength(const Plane& y, Size size, const Kernel& difference, const Kernel& bell) {
    const Plane across = filtered(y, size, difference, bell), down = filtered(y, size, bell, difference);
    Plane out;
    for (size_t i = 0; i < y.size(); ++i) out.push_back(std::hypot(across[i], down[i]));
    return out;
}

Seen see(std::span<const glm::vec3> light, Size size, double pixels_per_degree) {
    const glm::mat3 xyz_from_rgb(xyzFromRgb());
    std::vector<glm::vec3> xyz;
    Plane y;
    for (const glm::vec3& v : light) {
        xyz.push_back(xyz_from_rgb * glm::clamp(v, 0.0f, 1.0f));
        y.push_back(xyz.back().y);
    }
    const double deviation = 0.5 * 0.082 * pixels_per_degree; // pixels; an edge's peak and trough are two of them apart
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    const auto gauss = [&](double i) { return std::exp(-i * i / (2 * deviation * deviation)); };
    const Kernel bell = kernelOf(radius, gauss), first = kernelOf(radius, [&](double i) { return -i * gauss(i); }),
                 second = kernelOf(radius, [&](double i) { return (i * i / (deviation * deviation) - 1) * gauss(i); });
    return {seenColour(xyz, size, pixels_per_degree), strength(y, size, first, bell), strength(y, size, second, bell)};
}

// --- two pictures
// -----------------------------------------------------------------------------------------------------------------

// Colour distances below 0.4 of the largest possible take [0, 0.95], the rest what is left up to 1.
float redistributed(float distance, float largest) {
    constexpr float kPart = 0.4f, kTarget = 0.95f;
    const float part = kPart * largest;
    return distance < part ? kTarget / part * distance : kTarget + (distance - part) / (largest - part) * (1 - kTarget);
}

float compressed(float colour_distance) { return std::pow(colour_distance, 0.7f); }

} // namespace

std::vector<float> flipMap(int width, int height, std::span<const glm::vec3> value,
                           std::span<const glm::vec3> reference, float pixels_per_degree) {
    const Size size{width, height};
    const Seen v = see(value, size, pixels_per_degree), r = see(reference, size, pixels_per_degree);
    const glm::mat3 xyz_from_rgb(xyzFromRgb());
    const float largest = compressed(hyab(huntLab(xyz_from_rgb[1]), huntLab(xyz_from_rgb[2]))); // green against blue
    std::vector<float> out;
    for (size_t i = 0; i < value.size(); ++i) {
        const float colour = redistributed(compressed(hyab(v.colour[i], r.colour[i])), largest);
        const float edge = std::abs(v.edge[i] - r.edge[i]), point = std::abs(v.point[i] - r.point[i]);
        const float feature = std::sqrt(std::max(edge, point) / std::numbers::sqrt2_v<float>);
        out.push_back(std::min(std::pow(colour, 1 - feature), 1.0f)); // rounding may leave green against blue above 1
    }
    return out;
}

std::vector<float> flipMap(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display) {
    if (value.width != reference.width || value.height != reference.height ||
        value.radiance.size() != reference.radiance.size())
        throw std::invalid_argument("FLIP: the pictures differ in size");
    return flipMap(value.width, value.height, displayedLight(value, display), displayedLight(reference, display));
}

std::vector<glm::u8vec3> colourMap(std::span<const float> map) {
    // Matt Zucker's fit of matplotlib's magma, constant term first.
    constexpr std::array<std::array<float, 3>, 7> kMagma{{{-0.002136485f, -0.000749655f, -0.005386128f},
                                                          {0.251660541f, 0.677523244f, 2.494026599f},
                                                          {8.353717279f, -3.577719515f, 0.314467903f},
                                                          {-27.66873309f, 14.26473078f, -13.64921319f},
                                                          {52.17613981f, -27.94360607f, 12.94416944f},
                                                          {-50.76852537f, 29.04658282f, 4.234152994f},
                                                          {18.65570507f, -11.48977352f, -5.601961509f}}};
    std::vector<glm::u8vec3> out;
    for (const float entry : map) {
        const float x = entry > 0 ? std::min(entry, 1.0f) : 0; // also for NaN
        glm::vec3 colour(0);
        for (size_t term = kMagma.size(); term-- > 0;)
            colour = colour * x + glm::vec3(kMagma[term][0], kMagma[term][1], kMagma[term][2]);
        out.emplace_back(255.0f * glm::clamp(colour, 0.0f, 1.0f) + 0.5f);
    }
    return out;
}

} // namespace brume
