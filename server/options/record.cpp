#include "server/options/groups.h"

namespace brume {

void addRecordOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Record");
    g.option("--record", o.record, "file to write the session to: its scene and every command");
    g.option("--record-limit", o.record_limit, "of that file; then the recording ends")
        .range(1u, 1'000'000u)
        .unit("MIB");
    g.option("--replay", o.replay, "recorded file to step anew, without network, checking every state; and end");
    g.option("--frames", o.frames,
             "ticks between pictures of the scene's own camera while recording or replaying; 0: none")
        .range(0, 1'000'000);
}

} // namespace brume
