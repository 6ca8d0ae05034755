#include "server/options/groups.h"

namespace brume {

void addRecordOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Record");
    g.option("--record", o.record, "file to write the session to: its scene and every command");
    g.option("--record-limit", o.record_limit, "of that file; then the recording ends")
        .range(1u, 1'000'000u)
        .unit("MIB");
    g.option("--replay", o.replay, "recorded file to step anew, without network, checking every state; and end");
    g.flag("--look", o.look, "with --replay: serve viewers, who look at the recorded session, pause it and seek in it");
    g.option("--out", o.out, "with --replay: folder for a film, numbered pictures of the scene's own camera");
    g.option("--out-fps", o.fps, "pictures a second of that film").range(1, 60);
    g.option("--out-height", o.height, "pixels of its pictures, which are 16:9").range(90, 2160);
    g.option("--out-format", o.format, "of its pictures").oneOf({"jpeg", "png"});
    g.option("--frames", o.frames,
             "ticks between pictures of the scene's own camera while recording or replaying; 0: none")
        .range(0, 1'000'000);
}

} // namespace brume
