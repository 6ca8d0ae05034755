#include <string>
#include <vector>

#include "client/native/lit_reader.h"
#include "protocol/message.h"
#include "tests/fuzz/promise.h"

namespace brume::fuzz {
namespace {

size_t seen(const flatbuffers::String* text) { return text ? text->str().size() : 0; }

size_t seen(const flatbuffers::Vector<flatbuffers::Offset<flatbuffers::String>>* texts) {
    size_t bytes = 0;
    if (texts)
        for (const auto* text : *texts) bytes += seen(text);
    return bytes;
}

// Bytes of all text that a reader of the message copies: reading it is what the sanitizers watch.
size_t read(const wire::Parsed& parsed) {
    size_t bytes = 0;
    if (const auto* hello = parsed.as<wire::Hello>()) bytes += seen(hello->client());
    if (const auto* goodbye = parsed.as<wire::Goodbye>()) bytes += seen(goodbye->reason());
    if (const auto* error = parsed.as<wire::Error>()) bytes += seen(error->text());
    if (const auto* welcome = parsed.as<wire::Welcome>()) {
        bytes += seen(welcome->server()) + seen(welcome->scene()) + seen(welcome->device());
        bytes += seen(welcome->methods()) + seen(welcome->quadratures());
        if (welcome->settings())
            for (const auto* one : *welcome->settings())
                bytes += seen(one->path()) + seen(one->unit()) + seen(one->help()) + seen(one->choices());
        promise(welcome->camera() && welcome->camera()->position() && welcome->camera()->target(),
                "required fields are there");
    }
    if (const auto* state = parsed.as<wire::SceneState>()) {
        bytes += seen(state->method()) + seen(state->quadrature());
        if (const auto* plan = state->plan())
            bytes += seen(plan->method()) + seen(plan->quadrature()) + seen(plan->text());
        if (state->settings())
            for (const auto* value : *state->settings()) bytes += seen(value->text());
        if (state->passes())
            for (const auto* pass : *state->passes()) bytes += seen(pass->name());
    }
    if (const auto* pose = parsed.as<wire::Pose>())
        promise(pose->position() && pose->orientation(), "required fields are there");
    if (const auto* input = parsed.as<wire::Input>()) promise(input->command() != nullptr, "required fields are there");
    if (const auto* frame = parsed.as<wire::Frame>()) {
        promise(frame->position() && frame->orientation() && frame->stages(), "required fields are there");
        size_t pictures = 0, bits = 0; // every byte is read
        for (uint32_t view = 0; view < frame->jpeg_bytes()->size(); ++view)
            for (const uint8_t byte : parsed.view(view)) {
                ++pictures;
                bits |= byte;
            }
        promise(pictures == parsed.jpeg.size() && bits < 256, "the pictures are all that follows a frame");
    }
    if (const auto* lit = parsed.as<wire::LitParticles>()) {
        client::LitReader reader;
        if (const lit::Rows* rows = reader.read(*lit, parsed.jpeg)) {
            promise(rows->count <= lit::kMostParticles, "no more particles than allowed");
            for (const auto& column : rows->columns)
                promise(column.empty() || column.size() == rows->count, "a number for each particle");
        } else {
            promise(!reader.why().empty(), "what is refused has a reason");
        }
    }
    return bytes;
}

} // namespace

void message(Bytes input) {
    const std::vector<uint8_t> bytes(input.begin(), input.end()); // exactly so long, and aligned
    const auto parsed = wire::parse(bytes);
    if (!parsed) return;
    promise(parsed->type() > wire::Body::NONE && parsed->type() <= wire::Body::MAX, "a body that we know");
    // Texts may share bytes, within what the verifier's number of tables allows.
    promise(read(*parsed) <= 256 * (bytes.size() + 1), "a message holds what it says");
}

} // namespace brume::fuzz
