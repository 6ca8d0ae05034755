#include "tests/gpu/truth.h"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include "tests/gpu/reference_build.h"
#include "tools/reference/pixel.h"
#include "tools/reference/rows.h"

namespace brume::test {
namespace {

namespace fs = std::filesystem;

enum class Kind { pixels, picture, paths };

reference::Numbers keyOf(Kind kind, const reference::World& world, const reference::Camera& camera, double settings) {
    reference::Numbers key;
    key.add(double(kind)), key.add(world), key.add(camera), key.add(settings);
    return key;
}

fs::path folder() {
    const char* named = std::getenv("BRUME_TRUTH");
    return named ? named : "build/truth";
}

using Head = std::array<uint64_t, 3>; // key, build of the reference, hash of the numbers
Head headOf(uint64_t key, const std::vector<double>& numbers) {
    return {key, kReferenceBuild, XXH3_64bits(numbers.data(), numbers.size() * sizeof(double))};
}

std::optional<std::vector<double>> read(const fs::path& file, uint64_t key, size_t count) {
    std::ifstream in(file, std::ios::binary);
    Head head{};
    std::vector<double> numbers(count);
    in.read(reinterpret_cast<char*>(head.data()), sizeof(head));
    in.read(reinterpret_cast<char*>(numbers.data()), std::streamsize(count * sizeof(double)));
    if (!in || in.peek() != std::ifstream::traits_type::eof() || head != headOf(key, numbers)) return {};
    return numbers;
}

// Whole or not at all: other programs read and write at the same time. A disk that is full or read-only keeps nothing.
void write(const fs::path& file, uint64_t key, const std::vector<double>& numbers) {
    std::error_code failed;
    fs::create_directories(file.parent_path(), failed);
    const fs::path part = fmt::format("{}.{}", file.string(), ::getpid());
    const Head head = headOf(key, numbers);
    std::ofstream out(part, std::ios::binary);
    out.write(reinterpret_cast<const char*>(head.data()), sizeof(head));
    out.write(reinterpret_cast<const char*>(numbers.data()), std::streamsize(numbers.size() * sizeof(double)));
    out.close();
    if (out) fs::rename(part, file, failed);
    if (!out || failed) fs::remove(part, failed);
}

void put(std::vector<double>& numbers, glm::dvec3 v) { numbers.insert(numbers.end(), {v.x, v.y, v.z}); }
glm::dvec3 vectorAt(const std::vector<double>& numbers, size_t i) {
    return {numbers[i], numbers[i + 1], numbers[i + 2]};
}

} // namespace

std::vector<double> kept(const reference::Numbers& key, size_t count,
                         const std::function<std::vector<double>()>& make) {
    const fs::path where = folder();
    if (where.empty()) return make();
    const uint64_t hash = key.hash();
    const fs::path file = where / fmt::format("{:016x}", hash);
    if (std::optional<std::vector<double>> known = read(file, hash, count)) return std::move(*known);
    std::vector<double> made = make();
    write(file, hash, made);
    return made;
}

std::vector<TruePixel> truthOf(const reference::World& world, const reference::Camera& camera,
                               std::span<const glm::uvec2> pixels, double tolerance) {
    constexpr size_t kEach = 5;
    reference::Numbers key = keyOf(Kind::pixels, world, camera, tolerance);
    for (const glm::uvec2 pixel : pixels) key.add(double(pixel.x)), key.add(double(pixel.y));
    const std::vector<double> numbers = kept(key, kEach * pixels.size(), [&] {
        const reference::Stage stage(world, {.tolerance = tolerance});
        std::vector<double> made(kEach * pixels.size());
        reference::forRows(int(pixels.size()), 0, [&] {
            return [&, tracer = reference::PixelTracer(stage, camera)](int i) mutable {
                const reference::PixelResult pixel = tracer.at(pixels[size_t(i)]);
                double* out = &made[kEach * size_t(i)];
                for (int c = 0; c < 3; ++c) *out++ = pixel.total[c];
                *out++ = pixel.transmittance, *out = pixel.edge;
            };
        });
        return made;
    });
    std::vector<TruePixel> truth;
    for (size_t i = 0; i < numbers.size(); i += kEach)
        truth.push_back({vectorAt(numbers, i), numbers[i + 3], numbers[i + 4] != 0});
    return truth;
}

reference::Picture truePicture(const reference::World& world, const reference::Camera& camera, double tolerance) {
    constexpr size_t kEach = 7;
    const size_t size = size_t(camera.width) * size_t(camera.height);
    const std::vector<double> numbers = kept(keyOf(Kind::picture, world, camera, tolerance), kEach * size, [&] {
        const reference::Picture picture = reference::render(world, camera, {.tolerance = tolerance});
        std::vector<double> made;
        for (size_t i = 0; i < size; ++i)
            put(made, picture.radiance[i]), put(made, picture.background[i]), made.push_back(picture.transmittance[i]);
        return made;
    });
    reference::Picture picture{camera.width, camera.height, {}, {}, {}};
    for (size_t i = 0; i < numbers.size(); i += kEach) {
        picture.radiance.push_back(vectorAt(numbers, i)), picture.background.push_back(vectorAt(numbers, i + 3));
        picture.transmittance.push_back(numbers[i + 6]);
    }
    return picture;
}

reference::TrackedPicture truePaths(const reference::World& world, const reference::Camera& camera, int samples) {
    constexpr size_t kEach = 6;
    const size_t size = size_t(camera.width) * size_t(camera.height);
    const std::vector<double> numbers = kept(keyOf(Kind::paths, world, camera, samples), kEach * size, [&] {
        const reference::TrackedPicture picture = reference::track(world, camera, {.samples = samples});
        std::vector<double> made;
        for (size_t i = 0; i < size; ++i) put(made, picture.radiance[i]), put(made, picture.standard_error[i]);
        return made;
    });
    reference::TrackedPicture picture{camera.width, camera.height, {}, {}};
    for (size_t i = 0; i < numbers.size(); i += kEach)
        picture.radiance.push_back(vectorAt(numbers, i)), picture.standard_error.push_back(vectorAt(numbers, i + 3));
    return picture;
}

} // namespace brume::test
