// Makes the example messages of protocol/examples, and describes messages in JSON. All their numbers are exact in
// binary.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "protocol/message.h"

namespace brume::wire {

using Json = nlohmann::ordered_json;

struct Example {
    std::string name; // name of its file without ".bin"
    std::vector<uint8_t> bytes;
};

std::vector<Example> makeExamples();

// A message as JSON: {"type": "Ack", "body": {"frame": 41}}. Field names as in the schema, 64-bit integers as decimal
// strings, absent fields null, a frame's JPEG bytes in hexadecimal, view after view, under "jpeg".
Json describe(const Parsed& message);

} // namespace brume::wire
