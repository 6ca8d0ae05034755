#include "client/load/agreement.h"

#include <algorithm>

namespace brume::load {

void Agreement::told(size_t server, uint64_t tick, uint64_t hash) {
    Tick& at = window_[tick % kWindow];
    if (at.tick > tick) return;
    if (at.tick < tick) {
        at.tick = tick;
        at.words.clear();
        at.different = false;
    }
    const auto own = std::find_if(at.words.begin(), at.words.end(), [&](const Word& w) { return w.server == server; });
    if (own != at.words.end() && own->hash == hash) return; // another viewer's frame of the same tick
    if (own != at.words.end()) {
        own->hash = hash; // the server began anew
    } else {
        at.words.push_back({server, hash});
        if (at.words.size() == 2) ++compared_;
    }
    for (const Word& word : at.words) {
        if (word.hash == hash) continue;
        if (!at.different) ++different_;
        at.different = true;
        if (!first_ || tick < first_->tick) first_ = Difference{tick, word.server, server, word.hash, hash};
        return;
    }
}

} // namespace brume::load
