#include "server/gpu/counts.h"

#include <algorithm>

namespace brume::gpu {

Counts::Counts(const Device& device, uint32_t count, const char* name)
    : counts_(device, count * sizeof(uint32_t),
              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
              Memory::device, name),
      back_(device, count * sizeof(uint32_t), VK_BUFFER_USAGE_TRANSFER_DST_BIT, Memory::readback, name),
      before_(count, 0) {
    std::ranges::fill(back_.mapped<uint32_t>(count), 0);
}

void Counts::begin(Commands& commands) {
    if (begun_) return;
    begun_ = true;
    vkCmdFillBuffer(commands.handle(), counts_.handle(), 0, VK_WHOLE_SIZE, 0);
    transferToCompute(commands.handle());
}

void Counts::end(Commands& commands) {
    everythingBefore(commands.handle());
    const VkBufferCopy copy{0, 0, before_.size() * sizeof(uint32_t)};
    vkCmdCopyBuffer(commands.handle(), counts_.handle(), back_.handle(), 1, &copy);
    transferToHost(commands.handle());
}

uint32_t Counts::operator[](uint32_t i) const {
    back_.invalidate();
    return back_.mapped<uint32_t>(before_.size())[i];
}

uint32_t Counts::since(uint32_t i) {
    const uint32_t now = (*this)[i], more = now - before_[i];
    before_[i] = now;
    return more;
}

} // namespace brume::gpu
