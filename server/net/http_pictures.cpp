#include <fmt/format.h>

#include "server/net/http_connection.h"
#include "server/net/picture_reply.h"
#include "server/net/tcp_state.h"

namespace brume::net {
namespace {

namespace http = boost::beast::http;

constexpr char kBoundary[] = "brume-frame";
constexpr auto kRepeatAfter = std::chrono::seconds(1);      // of a stream: players take a longer pause for its end
constexpr uint8_t kSnapshotQuality = 90;                    // JPEG, as of every picture at rest
constexpr auto kLookAgain = std::chrono::milliseconds(100); // for the end of a connection with unread bytes
constexpr char kNoFrame[] = "no picture came in time: shaders may be compiling, which is done once; ask again";

// True if the client takes PNG and does not take JPEG.
bool prefersPng(const HttpRequest& request) {
    const auto accept = request[http::field::accept];
    const std::string_view types(accept.data(), accept.size());
    return types.find("image/png") != types.npos && types.find("image/jpeg") == types.npos &&
           types.find("image/*") == types.npos && types.find("*/*") == types.npos;
}

} // namespace

// A picture cannot be had now: says why, to the client and in the log, and when to try again.
asio::awaitable<bool> HttpConnection::sendLater(const HttpRequest& request, std::string_view route, std::string line) {
    context_->log.write(spdlog::level::info, slot_->network(),
                        fmt::format("{} for {} refused: {}", route, slot_->address(), line));
    Reply reply = lineReply(503, std::move(line));
    reply.headers = {{"Retry-After", "5"}};
    return send(request, route, std::move(reply));
}

Newcomer HttpConnection::newcomer(const Authorization& authorization) const {
    return {.owner = ownerOf(authorization, slot_->network()),
            .is_operator = authorization.role == Role::operator_,
            .max_in_flight = 1};
}

// One still picture of a camera that the query places, within the scene's error whatever the load.
asio::awaitable<bool> HttpConnection::snapshot(const HttpRequest& request, std::string_view kind,
                                               std::string_view query, Authorization authorization) {
    auto read = readPictureQuery(query, context_->options, room_->audience.scene()->scene.camera);
    if (auto* wrong = std::get_if<std::string>(&read))
        co_return co_await send(request, "snapshot", lineReply(400, std::move(*wrong)));
    PictureQuery& picture = std::get<PictureQuery>(read);
    if (kind == "exr") picture.request.alpha = Alpha::exr;
    picture.request.lossless = picture.request.lossless || kind == "png" || prefersPng(request);
    if (picture.request.alpha == Alpha::png && !picture.request.lossless)
        co_return co_await send(request, "snapshot", lineReply(400, "a JPEG has no alpha: /snapshot.png or .exr"));
    if (picture.request.alpha != Alpha::none && picture.request.show != 0)
        co_return co_await send(request, "snapshot", lineReply(400, "a view has no alpha: leave out view"));

    FramePtr frame;
    std::string refusal;
    {
        const auto [place, full] =
            context_->snapshots.take(ownerOf(authorization, slot_->network()), context_->options.max_snapshots);
        if (!place) {
            context_->metrics.refused("snapshots");
            co_return co_await sendLater(request, "snapshot", full);
        }
        const auto [handle, why] =
            ViewerHandle::join(room_->audience, room_->metrics, event_->notifier(), newcomer(authorization));
        if (!handle) {
            context_->metrics.refused("snapshots");
            co_return co_await sendLater(request, "snapshot", why);
        }
        PoseRequest pose = picture.request;
        pose.one_shot = true;
        if (!picture.has_quality) pose.quality = std::max(pose.quality, kSnapshotQuality);
        pose.received = Clock::now();
        handle->viewer().setPose(pose);
        const PeerWatch watch(*this);
        frame = co_await nextFrame(*handle, context_->options.frame_wait);
        refusal = handle->viewer().refusal();
    }
    if (gone_) co_return false;
    if (!refusal.empty()) co_return co_await send(request, "snapshot", lineReply(400, std::move(refusal)));
    if (!frame) co_return co_await sendLater(request, "snapshot", kNoFrame);
    room_->metrics.sent(frame->jpeg[0]->size(), 0);
    Reply reply;
    reply.content_type = contentTypeOf(*frame);
    reply.body.assign(frame->jpeg[0]->begin(), frame->jpeg[0]->end());
    reply.headers = headersOf(*frame, picture);
    reply.headers.emplace_back("Cache-Control", "no-store");
    tellIgnored(picture, reply);
    co_return co_await send(request, "snapshot", std::move(reply));
}

// Motion JPEG. A part that has not changed is sent again each second. Every part is followed by its boundary at once,
// so that a reader shows it without waiting for the next.
asio::awaitable<bool> HttpConnection::stream(const HttpRequest& request, std::string_view query,
                                             Authorization authorization) {
    auto read = readPictureQuery(query, context_->options, room_->audience.scene()->scene.camera);
    if (auto* wrong = std::get_if<std::string>(&read))
        co_return co_await send(request, "stream", lineReply(400, std::move(*wrong)));
    PictureQuery picture = std::get<PictureQuery>(read);

    if (picture.request.lossless || picture.request.alpha != Alpha::none)
        co_return co_await send(request, "stream", lineReply(400, "a stream is JPEG; /snapshot.png is a PNG"));
    const auto [place, full] =
        context_->streams.take(ownerOf(authorization, slot_->network()), context_->options.max_streams);
    if (!place) {
        context_->metrics.refused("streams");
        co_return co_await sendLater(request, "stream", full);
    }
    const auto [handle, why] =
        ViewerHandle::join(room_->audience, room_->metrics, event_->notifier(), newcomer(authorization));
    if (!handle) {
        context_->metrics.refused("streams");
        co_return co_await sendLater(request, "stream", why);
    }
    picture.request.received = Clock::now();
    handle->viewer().setPose(picture.request);
    const PeerWatch watch(*this);
    FramePtr frame = co_await nextFrame(*handle, context_->options.frame_wait);
    if (gone_) co_return false;
    if (std::string refusal = handle->viewer().refusal(); !refusal.empty())
        co_return co_await send(request, "stream", lineReply(400, std::move(refusal)));
    if (!frame) co_return co_await sendLater(request, "stream", kNoFrame);

    context_->metrics.requested("stream", 200);
    context_->log.write(spdlog::level::info, slot_->network(),
                        fmt::format("viewer {}: stream to {}, {}x{}", handle->viewer().id(), slot_->address(),
                                    picture.request.width, picture.request.height));
    Reply opening;
    opening.content_type = fmt::format("multipart/x-mixed-replace; boundary={}", kBoundary);
    opening.headers = {{"Cache-Control", "no-store"}, {"X-Accel-Buffering", "no"}}; // nginx passes each part on
    tellIgnored(picture, opening);
    share(request, opening);
    std::string head = headOf(opening, "close", context_->options) + fmt::format("\r\n--{}\r\n", kBoundary);
    const std::string tail = fmt::format("\r\n--{}\r\n", kBoundary);
    const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<float>(1 / picture.fps));
    auto due = Clock::now();
    const auto over = [&] {
        return gone_ || context_->stopping || Clock::now() >= authorization.until.value_or(Clock::time_point::max());
    };
    while (frame && !over()) {
        const std::vector<uint8_t>& jpeg = *frame->jpeg[0];
        head += fmt::format("Content-Type: image/jpeg\r\nContent-Length: {}\r\n", jpeg.size());
        for (const auto& [name, value] : headersOf(*frame, picture)) head += fmt::format("{}: {}\r\n", name, value);
        head += "\r\n";
        room_->metrics.sent(jpeg.size(), 0);
        const Parts part{asio::buffer(head), asio::buffer(jpeg), asio::buffer(tail)};
        const error_code error = co_await write(part);
        if (error) break;
        head.clear();
        // The next frame is asked for one period after this one, not at once.
        due = std::max(due + period, Clock::now());
        while (Clock::now() < due && !gone_ && !context_->stopping) co_await event_->wait(due);
        handle->viewer().acknowledge(frame->id);
        handle->viewer().observe(Clock::now(), false); // it gives up size and rate under load, as others do
        if (FramePtr next = co_await nextFrame(*handle, kRepeatAfter)) frame = std::move(next);
        if (!handle->viewer().refusal().empty()) break;
    }
    context_->log.write(
        spdlog::level::info, slot_->network(),
        fmt::format("viewer {}: stream ended after {} frames", handle->viewer().id(), handle->viewer().counts().sent));
    co_return false;
}

// Waits for the viewer's next frame. Null if no frame comes in time, the server refuses the viewer, or it stops; also
// if the peer goes while a PeerWatch lives.
asio::awaitable<FramePtr> HttpConnection::nextFrame(ViewerHandle& handle, Clock::duration patience) {
    const auto deadline = Clock::now() + patience;
    for (;;) {
        FramePtr frame = handle.takeFrame();
        const bool over = gone_ || context_->stopping || Clock::now() >= deadline || !handle.viewer().refusal().empty();
        if (frame || over) co_return frame;
        co_await event_->wait(deadline);
    }
}

HttpConnection::PeerWatch::PeerWatch(HttpConnection& connection) : connection_(connection) {
    const auto watch = [self = connection.shared_from_this(), over = over_] { return self->watchPeer(over); };
    asio::co_spawn(connection.stream_.get_executor(), watch, kLogFailure);
}

HttpConnection::PeerWatch::~PeerWatch() {
    *over_ = true;
    error_code ignored; // the socket may be closed
    connection_.stream_.tcp().socket().cancel(ignored);
}

// Reads nothing: what the peer sends while it waits is its next request.
asio::awaitable<void> HttpConnection::watchPeer(std::shared_ptr<const bool> over) {
    auto& socket = stream_.tcp().socket();
    asio::steady_timer pause(stream_.get_executor());
    while (!*over) {
        const auto [error] = co_await socket.async_wait(asio::ip::tcp::socket::wait_read, kToken);
        if (*over) co_return;
        if (error || peerHasGone(socket.native_handle())) {
            gone_ = true;
            stream_.tcp().close(); // ends a write that waits
            co_return event_->notify();
        }
        pause.expires_after(kLookAgain);
        co_await pause.async_wait(kToken);
    }
}

} // namespace brume::net
