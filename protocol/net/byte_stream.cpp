#include "protocol/net/byte_stream.h"

namespace brume {

void ByteStream::readSome(boost::asio::mutable_buffer buffer, AnyHandler done) {
    tls() ? tls()->async_read_some(buffer, std::move(done)) : tcp().async_read_some(buffer, std::move(done));
}

void ByteStream::writeSome(const Gathered& buffers, AnyHandler done) {
    tls() ? tls()->async_write_some(buffers, std::move(done)) : tcp().async_write_some(buffers, std::move(done));
}

} // namespace brume
