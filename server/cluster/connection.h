// What the connection to NATS is made of: owners of the library's objects, options, callbacks.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include <nats/nats.h>

#include "server/cluster/engine.h"

namespace brume::cluster {

inline constexpr int64_t kReconnectMs = 100;
inline constexpr int64_t kAnswerMs = 1000; // an answer that takes longer is asked for again

template <class T, void (*Destroy)(T*)>
struct Destroyer {
    void operator()(T* one) const { Destroy(one); }
};
template <class T, void (*Destroy)(T*)>
using Owned = std::unique_ptr<T, Destroyer<T, Destroy>>;
using Options = Owned<natsOptions, natsOptions_Destroy>;
using Connection = Owned<natsConnection, natsConnection_Destroy>;
using Context = Owned<jsCtx, jsCtx_Destroy>;
using Subscription = Owned<natsSubscription, natsSubscription_Destroy>;
using Message = Owned<natsMsg, natsMsg_Destroy>;
using Info = Owned<jsStreamInfo, jsStreamInfo_Destroy>;
using Values = Owned<kvStore, kvStore_Destroy>;
using Entry = Owned<kvEntry, kvEntry_Destroy>;

// What the library says of a status, and of the last error on this thread.
std::string textOf(natsStatus status);
// Throws EngineAway.
[[noreturn]] void away(const char* what, natsStatus status);

// Throws ClusterError where an option is no good.
Options optionsOf(const EngineOptions& from);

// What the library's callbacks know. They may come until `closed`, on a thread of its own.
struct Link {
    std::atomic<bool> connected{true}, closed{false};
    std::atomic<uint64_t> connections{1};
};
void setCallbacks(natsOptions* options, Link* link);

} // namespace brume::cluster
