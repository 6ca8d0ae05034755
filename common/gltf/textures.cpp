#include "common/gltf/textures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/gltf/pixels.h"

namespace brume::gltf {
namespace {

constexpr int kMostLevelTexels = 1024; // a side, of what is kept of an image
constexpr int kClampToEdge = 33071, kMirroredRepeat = 33648;

float linearOf(uint8_t code) {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> out{};
        for (size_t i = 0; i < out.size(); ++i) {
            const double value = double(i) / 255;
            out[i] = float(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
        }
        return out;
    }();
    return table[code];
}

uint8_t codeOf(double linear) {
    const double value = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    return uint8_t(std::clamp(255 * value + 0.5, 0.0, 255.0));
}

glm::vec4 linearOf(glm::u8vec4 texel) {
    return {linearOf(texel.r), linearOf(texel.g), linearOf(texel.b), float(texel.a) / 255};
}

// Mean of colours by their alpha; by their number where all alphas are 0.
class Mean {
public:
    void add(glm::u8vec4 texel) {
        const glm::dvec4 linear = linearOf(texel);
        plain_ += glm::dvec3(linear);
        weighted_ += linear.a * glm::dvec3(linear);
        alpha_ += linear.a;
        ++count_;
    }
    glm::dvec4 value() const {
        return {alpha_ > 0 ? weighted_ / alpha_ : plain_ / double(count_), alpha_ / double(count_)};
    }

private:
    glm::dvec3 plain_{0}, weighted_{0};
    double alpha_ = 0;
    size_t count_ = 0;
};

double wrapped(double at, int how) {
    if (!std::isfinite(at)) return 0;
    if (how == kClampToEdge) return std::clamp(at, 0.0, 1.0);
    if (how != kMirroredRepeat) return at - std::floor(at);
    const double two = at - 2 * std::floor(at / 2);
    return two > 1 ? 2 - two : two;
}

} // namespace

Image::Image(const Bytes& file, bool transparent, size_t most, size_t& left) {
    Pixels pixels = pixelsOf(file, kMostTexels, left);
    left -= pixels.texels.size();
    Mean all;
    for (glm::u8vec4& texel : pixels.texels) {
        if (!transparent) texel.a = 255;
        all.add(texel);
    }
    mean_ = all.value();
    int side = kMostLevelTexels;
    while (side > 1 && size_t(side) * size_t(side) * 6 > most) side /= 2;
    const Level whole{pixels.width, pixels.height, std::move(pixels.texels)};
    const int longest = std::max(whole.width, whole.height);
    levels_.push_back(coarser(whole, (longest + side - 1) / side));
    while (std::max(levels_.back().width, levels_.back().height) > 1) levels_.push_back(coarser(levels_.back(), 2));
}

Image::Level Image::coarser(const Level& from, int factor) {
    if (factor == 1) return from;
    Level out{(from.width + factor - 1) / factor, (from.height + factor - 1) / factor, {}};
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            Mean mean;
            for (int v = y * factor; v < std::min((y + 1) * factor, from.height); ++v)
                for (int u = x * factor; u < std::min((x + 1) * factor, from.width); ++u)
                    mean.add(from.texels[size_t(v) * size_t(from.width) + size_t(u)]);
            const glm::dvec4 value = mean.value();
            out.texels.emplace_back(codeOf(value.r), codeOf(value.g), codeOf(value.b), uint8_t(255 * value.a + 0.5));
        }
    return out;
}

glm::vec4 Image::at(glm::dvec2 place, double area) const {
    double texels = area * levels_[0].width * levels_[0].height;
    size_t level = 0;
    while (texels > 2 && level + 1 < levels_.size()) {
        texels /= 4;
        ++level;
    }
    const Level& in = levels_[level];
    if (in.texels.size() == 1) return mean_;
    const int x = std::clamp(int(place.x * in.width), 0, in.width - 1);
    const int y = std::clamp(int(place.y * in.height), 0, in.height - 1);
    return linearOf(in.texels[size_t(y) * size_t(in.width) + size_t(x)]);
}

size_t Image::bytes() const {
    size_t out = 0;
    for (const Level& level : levels_) out += level.texels.size() * sizeof(level.texels[0]);
    return out;
}

glm::dvec2 Texture::placeOf(glm::dvec2 uv) const {
    const glm::dvec2 at = transform * glm::dvec3(uv, 1);
    return {wrapped(at.x, wrap[0]), wrapped(at.y, wrap[1])};
}

glm::vec4 Texture::colourOf(const glm::dvec2 (&uv)[3]) const {
    const glm::dmat2 linear(transform[0], transform[1]);
    const glm::dvec2 a = linear * (uv[1] - uv[0]), b = linear * (uv[2] - uv[0]);
    const double area = 0.5 * std::abs(a.x * b.y - a.y * b.x);
    return image->at(placeOf((uv[0] + uv[1] + uv[2]) / 3.0), std::isfinite(area) ? area : 1);
}

Texture Textures::read(const Json& info, bool transparent) {
    Texture out;
    const std::optional<size_t> index = wholeIn(info, "index");
    if (!index) return out;
    const Json& texture = file_.at("textures", *index);
    if (const std::optional<size_t> source = wholeIn(texture, "source"))
        out.image = imageOf(*source, transparent);
    else
        file_.told.add("textures without a PNG or JPEG image are ignored", 1, "texture");
    out.set = wholeIn(info, "texCoord").value_or(0);
    if (const std::optional<size_t> sampler = wholeIn(texture, "sampler")) {
        const Json& how = file_.at("samplers", *sampler);
        const char* const keys[2]{"wrapS", "wrapT"};
        for (size_t i = 0; i < 2; ++i)
            out.wrap[i] = int(std::min<size_t>(wholeIn(how, keys[i]).value_or(size_t(out.wrap[i])), 1u << 16));
    }
    const Json& moved = extension(info, "KHR_texture_transform");
    if (moved.is_null()) return out;
    out.set = wholeIn(moved, "texCoord").value_or(out.set);
    double offset[2]{0, 0}, scale[2]{1, 1};
    numbersIn(moved, "offset", offset);
    numbersIn(moved, "scale", scale);
    const double angle = numberIn(moved, "rotation", 0), c = std::cos(angle), s = std::sin(angle);
    out.transform = {{c * scale[0], -s * scale[0]}, {s * scale[1], c * scale[1]}, {offset[0], offset[1]}};
    return out;
}

std::shared_ptr<const Image> Textures::imageOf(size_t index, bool transparent) {
    const auto [found, fresh] = images_.try_emplace({index, transparent});
    if (!fresh) return found->second;
    const Json& image = file_.at("images", index);
    try {
        found->second = std::make_shared<const Image>(file_.content(image), transparent, left_ / 4, texels_left_);
        left_ -= std::min(left_, found->second->bytes());
    } catch (const Wrong& wrong) {
        file_.told.add(fmt::format("images[{}] is ignored: {}", index, wrong.what()));
    }
    return found->second;
}

} // namespace brume::gltf
