// The example messages of protocol/examples: how they are made, and what they say in JSON. Numbers are exact in binary.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "protocol/message.h"

namespace brume::wire {

using Json = nlohmann::ordered_json;

struct Example {
    std::string name; // of its file, without ".bin"
    std::vector<uint8_t> bytes;
};

std::vector<Example> makeExamples();

// {"type": "Ack", "body": {"frame": 41}}; field names as in the schema, 64-bit integers as decimal strings, absent fields null,
// a frame's JPEG bytes in hexadecimal, view after view, under "jpeg".
Json describe(const Parsed& message);

} // namespace brume::wire
