// The part of WebSocketSession that carries out what messages ask for, and ends the session.
#include "server/net/outgoing.h"
#include "server/net/websocket_session.h"

namespace brume::net {
namespace {

namespace websocket = boost::beast::websocket;

constexpr float kRetryFull = 5; // s: Goodbye::retry_after_s of a full server

} // namespace

void WebSocketSession::carryOut(Actions& actions) {
    struct {
        WebSocketSession& s;
        void operator()(Admit& e) { s.admit(e); }
        void operator()(SetPose& e) {
            if (s.handle_) s.people().look(s.handle_->viewer().id(), e.request);
        }
        void operator()(SetPresence& e) {
            if (!s.handle_) return;
            s.people().say(s.handle_->viewer().id(), e.presence);
            s.people_news_.ask(e.presence.cameras);
        }
        void operator()(TakeLead& e) { s.lead(e.person); }
        void operator()(EnqueueCommand& e) { s.command(e); }
        void operator()(Acknowledge& e) { s.acknowledge(e.frame); }
        void operator()(Ponged& e) { s.ponged(e.nonce); }
        void operator()(AnswerPing& e) { s.enqueue(packPong(e.nonce, e.time_us)); }
        void operator()(SendError& e) {
            s.context_->metrics.refused(wire::EnumNameErrorCode(e.code));
            s.enqueue(packError(e.code, e.text, e.input_seq));
        }
        void operator()(Close& e) { s.close(e.code, e.reason); }
    } each{*this};
    for (Action& action : actions) {
        if (closing_ || ended_) return;
        std::visit(each, action);
    }
}

void WebSocketSession::admit(const Admit& hello) {
    auto [handle, why] = ViewerHandle::join(room_->audience, room_->metrics, event_->notifier(),
                                            {.owner = ownerOf(authorization_, slot_->network()),
                                             .is_operator = authorization_.role == Role::operator_,
                                             .key = hello.resume,
                                             .token = authorization_.name,
                                             .draws = hello.granted.draw_hz > 0,
                                             .role = uint8_t(authorization_.role),
                                             .is_person = true});
    handle_ = std::move(handle);
    if (!handle_) {
        context_->metrics.refused(wire::EnumNameErrorCode(wire::ErrorCode::full));
        log(fmt::format("{} from {}: turned away, {}", hello.client, slot_->address(), why));
        enqueue(packError(wire::ErrorCode::full, why, 0));
        const std::string go_to = room_->elsewhere.url();
        return close(kCloseTryLater, why, go_to.empty() ? kRetryFull : 0, go_to);
    }
    handle_->viewer().grant(hello.granted);
    name_ = fmt::format("viewer {}", handle_->viewer().id());
    const std::string whose = authorization_.name.empty() ? "" : fmt::format(" ({})", authorization_.name);
    log(fmt::format("{}{}: {} from {}, {}x{}, {}, {}", name_, whose, hello.client, slot_->address(),
                    hello.granted.width, hello.granted.height, hello.granted.views == 1 ? "one eye" : "two eyes",
                    nameOf(authorization_.role)));
    granted_ = hello.granted;
    enqueue(welcome());
}

void WebSocketSession::acknowledge(uint32_t frame) {
    if (handle_->viewer().acknowledge(frame)) return;
    Actions refusal;
    rules_.onUnknownFrame(frame, Clock::now(), refusal);
    carryOut(refusal);
}

void WebSocketSession::command(const EnqueueCommand& given) {
    const std::optional<Refusal> refusal = giveCommand(room_->audience, handle_->viewer().id(), given.seq, given.body);
    if (!refusal) return;
    context_->metrics.refused(wire::EnumNameErrorCode(refusal->code));
    enqueue(packError(refusal->code, refusal->text, given.seq));
}

void WebSocketSession::lead(uint32_t person) {
    if (people().lead(person))
        return log(person == 0 ? fmt::format("{}: nobody presents any more", name_)
                               : fmt::format("{}: viewer {} presents", name_, person));
    Actions refusal;
    rules_.onUnknownPerson(person, Clock::now(), refusal);
    carryOut(refusal);
}

// The viewer leaves the audience at once. The connection ends when all control messages are sent.
void WebSocketSession::close(uint16_t code, std::string_view reason, float retry_after_s, const std::string& go_to) {
    if (closing_ || ended_) return;
    enqueue(packGoodbye(reason, retry_after_s, context_->stopping ? room_->goTo(context_->go_to) : go_to));
    leave(reason);
    closing_ =
        websocket::close_reason(websocket::close_code(code), boost::beast::string_view(reason.data(), reason.size()));
    event_->notify();
}

void WebSocketSession::leave(std::string_view why) {
    if (!handle_) return;
    const auto counts = handle_->viewer().counts();
    log(fmt::format("{}: left ({}), {} frames rendered, {} sent", name_, why, counts.rendered, counts.sent));
    handle_.reset();
}

// Of commands that turned out to be impossible at their tick.
void WebSocketSession::tellRefusedInputs() {
    if (!handle_) return;
    for (const Viewer::RefusedInput& input : handle_->viewer().takeRefusedInputs()) {
        context_->metrics.refused(wire::EnumNameErrorCode(wire::ErrorCode::out_of_range));
        enqueue(packError(wire::ErrorCode::out_of_range, input.why, input.seq));
    }
}

} // namespace brume::net
