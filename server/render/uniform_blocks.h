// Where the uniform blocks of one submission lie in its buffer:
//
//   | gpu::View, one per eye | DrawnEye, one per eye, of the pixels drawn | of every hue gpu::Tick, and one per level
//   of detail |
#pragma once

#include "server/gpu/program.h"
#include "shaders/shared/types.h"

namespace brume {

// An eye with its rays in the sun's map, as uniform blocks hold it; a gpu::View begins so.
struct DrawnEye {
    gpu::Eye eye;
    gpu::MapRays map_rays;
};

class UniformBlocks {
public:
    UniformBlocks(const gpu::Buffer& buffer, size_t eyes) : buffer_(buffer), eyes_(uint32_t(eyes)) {}
    static VkDeviceSize bytes(size_t eyes, size_t hues) { return (2 * eyes + hues * (eyes + 1)) * kBlockBytes; }

    void setTick(uint32_t hue, const gpu::Tick& tick) const { buffer_.mapped<gpu::Tick>(1, atTick(hue))[0] = tick; }
    void setPicture(uint32_t eye, const gpu::View& view) const { buffer_.mapped<gpu::View>(1, at(eye))[0] = view; }
    void setLevel(uint32_t hue, uint32_t level, const gpu::Tick& tick) const {
        buffer_.mapped<gpu::Tick>(1, atLevel(hue, level))[0] = tick;
    }
    void setDrawn(uint32_t eye, const DrawnEye& drawn) const {
        buffer_.mapped<DrawnEye>(1, at(eyes_ + eye))[0] = drawn;
    }

    gpu::Resource tick(uint32_t hue) const {
        return gpu::uniformBuffer("TickBlock", buffer_, atTick(hue), sizeof(gpu::Tick));
    }
    gpu::Resource picture(uint32_t eye) const {
        return gpu::storageBuffer("Views", buffer_, at(eye), sizeof(gpu::View));
    }
    gpu::Resource pictureEye(uint32_t eye) const {
        return gpu::uniformBuffer("EyeBlock", buffer_, at(eye), sizeof(DrawnEye));
    }
    gpu::Resource level(uint32_t hue, uint32_t level) const {
        return gpu::uniformBuffer("TickBlock", buffer_, atLevel(hue, level), sizeof(gpu::Tick));
    }
    gpu::Resource drawnEye(uint32_t eye) const {
        return gpu::uniformBuffer("EyeBlock", buffer_, at(eyes_ + eye), sizeof(DrawnEye));
    }

private:
    static constexpr VkDeviceSize kBlockBytes =
        768; // a multiple of 256, the largest alignment that a device may ask for
    static_assert(sizeof(gpu::Tick) <= kBlockBytes && sizeof(gpu::View) <= kBlockBytes &&
                  offsetof(gpu::View, eye) == 0);
    static VkDeviceSize at(uint32_t block) { return block * kBlockBytes; }
    VkDeviceSize atTick(uint32_t hue) const { return at(2 * eyes_ + hue * (eyes_ + 1)); }
    VkDeviceSize atLevel(uint32_t hue, uint32_t level) const { return atTick(hue) + at(1 + level); }

    const gpu::Buffer& buffer_;
    uint32_t eyes_;
};

} // namespace brume
