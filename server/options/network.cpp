#include "server/options/groups.h"

namespace brume {

void addNetworkOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Network");
    g.option("--listen", o.net.listen, "address; 0.0.0.0 or :: lets other machines in");
    g.option("--port", o.net.port, "0 takes a free one").range(0, 65535);
    g.option("--web-root", o.net.web_root, "folder of the built page");
    g.several("--allow-origin", o.net.allowed_origins, ',', "pages of this origin may connect too; * for any").live();
}

} // namespace brume
