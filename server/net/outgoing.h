// Packs the server's messages for the socket.
#pragma once

#include <string_view>

#include "protocol/message.h"
#include "server/viewer/audience.h"

namespace brume::net {

// `shown`: the scene that is shown.
wire::Packed packWelcome(const Viewer& viewer, const PoseRequest& granted, const Audience& audience,
                         const SceneFacts& shown, wire::Role role);
// `lists_for`: of the server, to tell the elements of the scene's lists, too; null: they are left out.
wire::Packed packSceneState(const SceneReport& report, uint32_t viewers, const ServerFacts* lists_for = nullptr);
// `cameras`: true to tell where each looks from.
wire::Packed packPeople(const People::Now& now, bool cameras);
// A frame's message without its JPEG bytes, which follow it. `queue_ms`: time since the JPEG was ready.
wire::Packed packFrameHeader(const EncodedFrame& frame, float queue_ms);
// Header of a frame whose medium the viewer draws. Its rows' bytes follow.
wire::Packed packLitHeader(const EncodedFrame& frame, float queue_ms);
wire::Packed packError(wire::ErrorCode code, std::string_view text, uint32_t input_seq);
// `go_to`: a URL, or empty.
wire::Packed packGoodbye(std::string_view reason, float retry_after_s, std::string_view go_to = {});
wire::Packed packPing(uint32_t nonce, uint64_t time_us);
wire::Packed packPong(uint32_t nonce, uint64_t time_us);

} // namespace brume::net
