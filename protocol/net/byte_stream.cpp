#include "protocol/net/byte_stream.h"

#include <boost/asio/bind_executor.hpp>

namespace brume {

void ByteStream::readSome(boost::asio::mutable_buffer buffer, AnyHandler done) {
    const auto executor = done.get_executor();
    auto counted = boost::asio::bind_executor(
        executor, [count = received_, then = std::move(done)](boost::system::error_code error, size_t bytes) mutable {
            *count += bytes;
            then(error, bytes);
        });
    tls() ? tls()->async_read_some(buffer, std::move(counted)) : tcp().async_read_some(buffer, std::move(counted));
}

void ByteStream::writeSome(const Gathered& buffers, AnyHandler done) {
    tls() ? tls()->async_write_some(buffers, std::move(done)) : tcp().async_write_some(buffers, std::move(done));
}

} // namespace brume
