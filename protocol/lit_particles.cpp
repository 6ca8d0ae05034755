#include "protocol/lit_particles.h"

#include <new>

#include <zlib.h>

namespace brume::lit {
namespace {

// Of zlib. Columns are noise with runs: looking for repeats takes time, and saves nothing.
constexpr int kLevel = 1, kStrategy = Z_RLE, kWindowBits = 15, kMemory = 9;
constexpr size_t kLeastBlock = 1024; // bytes of plain columns that have codes of their own

// Small differences, up or down, as small numbers.
uint16_t folded(uint16_t difference, uint32_t bits) {
    const auto up = uint16_t(difference << 1);
    const bool negative = (difference >> (bits - 1)) & 1;
    return uint16_t((negative ? ~up : up) & ((1u << bits) - 1));
}
uint16_t unfolded(uint16_t number) { return uint16_t((number >> 1) ^ (number & 1 ? 0xffff : 0)); }

// Numbers of the reference's column for particles of these rows: 0 where it has none.
class Before {
public:
    Before(const Rows* reference, uint32_t column, uint64_t first)
        : numbers_(reference ? std::span<const uint16_t>(reference->columns[column]) : std::span<const uint16_t>()),
          offset_(reference ? first - reference->first : 0) {}
    uint16_t operator[](uint32_t row) const {
        const uint64_t at = row + offset_; // wraps around for particles before the reference's first
        return at < numbers_.size() ? numbers_[at] : uint16_t(0);
    }

private:
    std::span<const uint16_t> numbers_;
    uint64_t offset_;
};

} // namespace

uint64_t plainBytes(uint64_t present, uint32_t count) {
    uint64_t bytes = 0;
    for (uint32_t column = 0; column < kColumns; ++column)
        if (present >> column & 1) bytes += bitsOf(column) / 8 * uint64_t{count};
    return bytes;
}

struct Packer::Deflate {
    z_stream stream{};
    Deflate() {
        if (deflateInit2(&stream, kLevel, Z_DEFLATED, kWindowBits, kMemory, kStrategy) != Z_OK) throw std::bad_alloc();
    }
    ~Deflate() { deflateEnd(&stream); }
    Deflate(const Deflate&) = delete;
    Deflate& operator=(const Deflate&) = delete;
};

Packer::Packer() : zlib_(std::make_unique<Deflate>()) {}
Packer::~Packer() = default;

// A block for each part: its codes fit its own numbers.
void Packer::deflate(std::vector<uint8_t>& out) {
    z_stream& stream = zlib_->stream;
    deflateReset(&stream);
    out.resize(deflateBound(&stream, uLong(plain_.size())) + 64 * (ends_.size() + 1));
    stream.next_out = out.data();
    stream.avail_out = uInt(out.size());
    size_t begin = 0;
    const auto part = [&](size_t end, int flush) {
        stream.next_in = plain_.data() + begin;
        stream.avail_in = uInt(end - begin);
        begin = end;
        while (::deflate(&stream, flush) != Z_STREAM_END &&
               (stream.avail_in > 0 || stream.avail_out == 0 || flush == Z_FINISH)) {
            const size_t used = out.size() - stream.avail_out; // more than zlib's bound, which knows no flushes
            out.resize(2 * out.size());
            stream.next_out = out.data() + used;
            stream.avail_out = uInt(out.size() - used);
        }
    };
    for (const size_t end : ends_)
        if (end - begin >= kLeastBlock) part(end, Z_BLOCK);
    part(plain_.size(), Z_FINISH);
    out.resize(out.size() - stream.avail_out);
}

PackedRows Packer::pack(const Rows& rows, const Rows* reference) {
    PackedRows packed;
    plain_.clear();
    ends_.clear();
    for (uint32_t column = 0; column < kColumns; ++column) {
        const std::vector<uint16_t>& numbers = rows.columns[column];
        const Before before(reference, column, rows.first);
        const uint32_t bits = bitsOf(column);
        const size_t begin = plain_.size();
        plain_.resize(begin + size_t{rows.count} * bits / 8);
        uint16_t any = 0;
        for (uint32_t i = 0; i < rows.count; ++i) {
            const auto own = numbers.empty() ? uint16_t(0) : numbers[i];
            const uint16_t number = folded(uint16_t(own - before[i]), bits);
            any |= number;
            plain_[begin + i] = uint8_t(number);
            if (bits == 16) plain_[begin + rows.count + i] = uint8_t(number >> 8);
        }
        if (any == 0) {
            plain_.resize(begin);
            continue;
        }
        packed.present |= uint64_t{1} << column;
        if (bits == 16) ends_.push_back(begin + rows.count);
        ends_.push_back(plain_.size());
    }
    deflate(packed.bytes);
    return packed;
}

std::optional<Rows> unpack(uint64_t first, uint32_t count, uint64_t present, std::span<const uint8_t> bytes,
                           const Rows* reference) {
    if (count > kMostParticles || present >> kColumns != 0) return {};
    std::vector<uint8_t> plain(plainBytes(present, count));
    auto length = uLongf(plain.size());
    auto taken = uLong(bytes.size());
    // An empty buffer may be null, which zlib takes for an error.
    uint8_t none = 0;
    if (uncompress2(plain.empty() ? &none : plain.data(), &length, bytes.data(), &taken) != Z_OK ||
        length != plain.size() || taken != bytes.size())
        return {};
    Rows rows{first, count, {}};
    size_t at = 0;
    for (uint32_t column = 0; column < kColumns; ++column) {
        const bool there = present >> column & 1;
        if (!there && (!reference || reference->columns[column].empty())) continue;
        const Before before(reference, column, first);
        const uint32_t bits = bitsOf(column);
        std::vector<uint16_t>& numbers = rows.columns[column];
        numbers.resize(count);
        for (uint32_t i = 0; i < count; ++i) {
            uint16_t number = 0;
            if (there) {
                number = plain[at + i];
                if (bits == 16) number = uint16_t(number | plain[at + count + i] << 8);
            }
            numbers[i] = uint16_t((before[i] + unfolded(number)) & ((1u << bits) - 1));
        }
        if (there) at += size_t{count} * bits / 8;
    }
    return rows;
}

} // namespace brume::lit
