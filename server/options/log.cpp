#include "server/options/groups.h"

namespace brume {

void addLogOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Log");
    g.option("--log-level", o.log_level, "debug | info | warn | error")
        .oneOf({"debug", "info", "warn", "error"})
        .live();
    g.option("--log-format", o.log_format, "text | json: a JSON object a line").oneOf({"text", "json"});
    g.option("--log-file", o.log_file, "instead of standard error");
}

} // namespace brume
