// What a reply with a picture says of it: its format, and headers with its state, size and error.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "server/net/picture_query.h"
#include "server/net/reply.h"

namespace brume::net {

const char* contentTypeOf(const EncodedFrame& frame);

// Brume-Tick, Brume-State (the hash of the simulation's state, 16 hexadecimal digits), Brume-Size (WIDTHxHEIGHT,
// pixels), Brume-Error (relative RMSE of the picture, predicted, at most), and Brume-Asked where the size that was
// asked for is cut down.
std::vector<std::pair<std::string, std::string>> headersOf(const EncodedFrame& frame, const PictureQuery& query);

// Adds Brume-Ignored: the parameters of the query that have no meaning, if there are any.
void tellIgnored(const PictureQuery& query, Reply& reply);

} // namespace brume::net
