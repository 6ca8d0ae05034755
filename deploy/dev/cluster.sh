# shellcheck shell=bash
# Part of ./dev: `./dev cluster`, a whole cluster on this machine: NATS, nodes, HAProxy in front of them, Prometheus.

readonly cluster_packages=(nats-server haproxy prometheus curl)
cluster_names=() # of the processes that run, in the order in which they began
cluster_pids=()
cluster_folder= # logs and data
cluster_stop=   # exit code, once a signal has come
cluster_is_in=  # set once all nodes have been in
cluster_port=   # of the cloud; the others follow from it
cluster_node=() # the command of every node, but for its name and ports
declare -A cluster_again # by name: in SECONDS, when a node that ends is started again

clusterHelp() {
    cat <<'END'
./dev cluster [--nodes N] [--scene NAME] [--port P] [-- SERVER OPTIONS]

Several servers of one cloud on this machine: NATS, N nodes (3; 1 to 9), HAProxy, Prometheus. Ctrl-C ends them all.
A node that ends is started again, as systemd would: kill one, and watch its viewers go on (docs/cluster.md).
The cloud is at port P (8080). Besides it takes, all on 127.0.0.1: P+1 to P+9 nodes, P+10 Prometheus, P+11 to P+19
agents of the nodes, P+20 metrics of HAProxy and of every node, P+21 and P+22 NATS.
Logs and data are in build/cluster/P, and new at each start. The services nats-server and prometheus that Debian's
packages may have started, at ports 4222 and 9090, are others and stay as they are.
END
}

# startPart NAME COMMAND...: in a session of its own, so that Ctrl-C reaches this script alone, which ends it in turn.
startPart() {
    local name=$1
    shift
    setsid "$@" >>"$cluster_folder/$name.log" 2>&1 </dev/null &
    cluster_pids+=($!)
    cluster_names+=("$name")
}

# The end of a log, and the complaint. In `die` alone the reason would be a file away.
failPart() { # failPart NAME WHAT
    local log=$cluster_folder/$1.log
    printf '\n   The end of %s:\n' "$log" >&2
    tail -n 15 "$log" >&2
    die "$1 $2; all others end. Its log: $log"
}

# Has a signal come, or one of the processes ended? Then end; of a process say which.
checkParts() {
    local i
    [[ -z "$cluster_stop" ]] || exit "$cluster_stop"
    for i in "${!cluster_pids[@]}"; do
        kill -0 "${cluster_pids[i]}" 2>/dev/null || partEnded "$i"
    done
}

# A node begins again once all have been in. One that began again less than ten seconds ago has a reason to end.
partEnded() { # partEnded PLACE
    local i=$1 name=${cluster_names[$1]}
    if [[ -z "$cluster_is_in" || $name != n[0-9] ]] || ((SECONDS < ${cluster_again[$name]:-0})); then
        failPart "$name" "has ended"
    fi
    echo "   $name has ended and is started again; its log: $cluster_folder/$name.log"
    unset "cluster_names[$i]" "cluster_pids[$i]"
    cluster_again[$name]=$((SECONDS + 10))
    startNode "${name#n}"
}

# waitForPart NAME SECONDS COMMAND...: until the command succeeds.
waitForPart() {
    local name=$1 end=$((SECONDS + $2))
    shift 2
    until "$@" >/dev/null 2>&1; do
        checkParts
        ((SECONDS < end)) || failPart "$name" "is not ready in time"
        sleep 0.1
    done
}

# Nodes first: they say Goodbye to their viewers, by HAProxy.
endCluster() {
    trap '' INT TERM HUP
    trap - EXIT
    endParts 'n[0-9]'
    endParts '*'
}
endParts() { # endParts PATTERN
    local i ending=()
    for i in "${!cluster_pids[@]}"; do
        # shellcheck disable=SC2053 # a pattern
        [[ "${cluster_names[i]}" == $1 ]] || continue
        kill "${cluster_pids[i]}" 2>/dev/null || true
        ending+=("${cluster_pids[i]}")
    done
    for i in "${ending[@]}"; do
        waitForEnd "$i"
    done
}
waitForEnd() { # waitForEnd PID: 15 s at most, then it is killed
    local tries=150
    while kill -0 "$1" 2>/dev/null && ((tries-- > 0)); do
        sleep 0.1
    done
    kill -KILL "$1" 2>/dev/null || true
}

freePorts() { # freePorts PORT...
    local port
    for port in "$@"; do
        ! (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null ||
            die "port $port is in use. Another --port moves all of them (./dev cluster --help)."
    done
}

# nodesConfig NODES PORT: HAProxy's list of them, as deploy/haproxy/nodes.cfg.
nodesConfig() {
    local i
    grep -E '^ *(backend|use-server|force-persist)' deploy/haproxy/nodes.cfg
    for ((i = 1; i <= $1; i++)); do
        echo "    server n$i 127.0.0.1:$(($2 + i)) cookie n$i agent-port $(($2 + 10 + i))"
    done
}

# targetsConfig NODES PORT: what Prometheus asks, as deploy/prometheus/targets.json.
targetsConfig() {
    local i address="\"targets\": [\"127.0.0.1:$(($2 + 20))\"]"
    echo '['
    for ((i = 1; i <= $1; i++)); do
        echo "  {$address, \"labels\": {\"instance\": \"n$i\", \"__metrics_path__\": \"/node/n$i/metrics\"}},"
    done
    echo "  {$address, \"labels\": {\"job\": \"haproxy\", \"instance\": \"haproxy\"}}"
    echo ']'
}

# allNodesAreIn NODES PORT: by HAProxy's own checks.
allNodesAreIn() {
    curl -fsS -m 2 "http://127.0.0.1:$(($2 + 20))/metrics" |
        grep -q "^haproxy_backend_active_servers{proxy=\"nodes\"} $1\$"
}

startNode() { # startNode NUMBER
    startPart "n$1" "${cluster_node[@]}" --port $((cluster_port + $1)) --agent-port $((cluster_port + 10 + $1))
}

startCluster() { # startCluster NODES SCENE PORT [SERVER OPTIONS]
    local nodes=$1 scene=$2 port=$3 i
    shift 3
    cluster_port=$port
    cluster_node=("$release/bin/brume-server" --scene "$scene" --open --proxy-protocol
        --cluster "nats://127.0.0.1:$((port + 21))" "$@")
    startPart nats nats-server -a 127.0.0.1 -p $((port + 21)) -m $((port + 22)) -js -sd "$cluster_folder/data/nats"
    waitForPart nats 20 curl -fsS -m 2 "http://127.0.0.1:$((port + 22))/healthz"
    for ((i = 1; i <= nodes; i++)); do
        startNode "$i"
    done
    startPart haproxy env BRUME_BIND="127.0.0.1:$port" BRUME_METRICS_BIND="127.0.0.1:$((port + 20))" \
        haproxy -db -f deploy/haproxy/haproxy.cfg -f "$cluster_folder/nodes.cfg"
    startPart prometheus prometheus --config.file="$cluster_folder/prometheus.yml" \
        --storage.tsdb.path="$cluster_folder/data/prometheus" --web.listen-address="127.0.0.1:$((port + 10))"
    waitForPart prometheus 20 curl -fsS -m 2 "http://127.0.0.1:$((port + 10))/-/ready"
    waitForPart haproxy 120 allNodesAreIn "$nodes" "$port" # a CPU driver compiles its shaders first
    cluster_is_in=1
}

commandCluster() { # [--nodes N] [--scene NAME] [--port P] [-- SERVER OPTIONS]
    local nodes=3 scene=plume port=8080 i
    while (($# > 0)); do
        case "$1" in
        --nodes | --scene | --port)
            [[ -n "${2:-}" ]] || die "$1 takes a value."
            local "${1#--}=$2"
            shift
            ;;
        --)
            shift
            break
            ;;
        -h | --help)
            clusterHelp
            return
            ;;
        *) die "./dev cluster knows no '$1'; options of the servers go after -- (./dev cluster --help)." ;;
        esac
        shift
    done
    [[ "$nodes" =~ ^[1-9]$ ]] || die "--nodes takes 1 to 9."
    [[ "$port" =~ ^[1-9][0-9]{0,4}$ && "$port" -le 65513 ]] || die "--port takes 1 to 65513."
    setUp "${build_packages[@]}" "${page_packages[@]}" "${cluster_packages[@]}"
    build release brume-server
    page
    local ports=("$port")
    for ((i = 1; i <= nodes; i++)); do
        ports+=($((port + i)) $((port + 10 + i)))
    done
    freePorts "${ports[@]}" $((port + 10)) $((port + 20)) $((port + 21)) $((port + 22))

    cluster_folder=$root/build/cluster/$port
    rm -rf "$cluster_folder"
    mkdir -p "$cluster_folder/data"
    cp deploy/prometheus/{prometheus,rules,alerts}.yml "$cluster_folder"
    nodesConfig "$nodes" "$port" >"$cluster_folder/nodes.cfg"
    targetsConfig "$nodes" "$port" >"$cluster_folder/targets.json"

    # A signal is remembered: so none comes between a process and its place in the lists.
    trap endCluster EXIT
    trap 'cluster_stop=130' INT
    trap 'cluster_stop=143' TERM HUP
    say "Starting NATS, $nodes nodes, HAProxy and Prometheus; logs: build/cluster/$port"
    startCluster "$nodes" "$scene" "$port" "$@"
    say "The cloud: http://127.0.0.1:$port    Prometheus: http://127.0.0.1:$((port + 10))    Ctrl-C ends them all"
    while checkParts; do
        sleep 0.2
    done
}
