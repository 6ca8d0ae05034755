#include "common/volume/gzip.h"

#include <algorithm>

#include <fmt/format.h>
#include <zlib.h>

namespace brume {
namespace {

constexpr int kGzipAlone = 15 + 16;          // zlib's window bits, with the header of gzip
constexpr uint64_t kFirst = 64 << 10;        // bytes of memory to begin with
constexpr uint64_t kMostAtOnce = 1ull << 30; // bytes that zlib is given, or asked for

class Inflate {
public:
    explicit Inflate(std::string_view packed) : left_(packed) { ready_ = inflateInit2(&stream_, kGzipAlone) == Z_OK; }
    ~Inflate() { inflateEnd(&stream_); }
    Inflate(const Inflate&) = delete;
    Inflate& operator=(const Inflate&) = delete;

    // Unpacks up to `room` bytes, adds their number to `made`, and returns zlib's answer.
    int into(char* to, uint64_t room, uint64_t& made) {
        if (!ready_) return Z_MEM_ERROR;
        const auto given = uInt(std::min<uint64_t>(left_.size(), kMostAtOnce));
        const auto wanted = uInt(std::min(room, kMostAtOnce));
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(left_.data())); // which zlib only reads
        stream_.avail_in = given;
        stream_.next_out = reinterpret_cast<Bytef*>(to);
        stream_.avail_out = wanted;
        const int answer = inflate(&stream_, Z_NO_FLUSH);
        left_.remove_prefix(given - stream_.avail_in);
        made += wanted - stream_.avail_out;
        return answer;
    }
    // Files may follow each other in one, as if what they hold were one.
    bool next() { return !left_.empty() && inflateReset(&stream_) == Z_OK; }
    const char* complaint() const { return stream_.msg ? stream_.msg : "zlib refuses them"; }

private:
    z_stream stream_{};
    std::string_view left_;
    bool ready_ = false;
};

} // namespace

std::string unpackGzip(std::string_view packed, uint64_t size, std::string& out) {
    Inflate unpacker(packed);
    out.clear();
    for (uint64_t made = 0;;) {
        char beyond = 0;
        if (made == out.size() && made < size) out.resize(std::min(size, std::max(kFirst, 2 * made)));
        const bool full = made == size; // True: all bytes are there; the end of the packed ones makes none
        const int answer = full ? unpacker.into(&beyond, 1, made) : unpacker.into(&out[made], out.size() - made, made);
        if (made > size) return fmt::format("its packed voxels are more than {} bytes", size);
        if (answer == Z_BUF_ERROR)
            return fmt::format("its packed voxels end early: {} of {} bytes are there", made, size);
        if (answer != Z_OK && answer != Z_STREAM_END)
            return fmt::format("its packed voxels are corrupt: {}", unpacker.complaint());
        if (answer == Z_OK || unpacker.next()) continue;
        return made == size ? "" : fmt::format("its packed voxels are {} bytes, fewer than {}", made, size);
    }
}

} // namespace brume
