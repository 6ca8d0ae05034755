// How many processors control groups leave a process, by files as Linux has them.
#include "common/cores.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

namespace brume {
namespace {

namespace fs = std::filesystem;

class Cores : public testing::Test {
protected:
    const fs::path folder_ = fs::temp_directory_path() / ("brume-cores-" + std::to_string(::getpid()));

    void SetUp() override { fs::remove_all(folder_); }
    void TearDown() override { fs::remove_all(folder_); }
    void write(const fs::path& file, const std::string& text) const {
        fs::create_directories((folder_ / file).parent_path());
        std::ofstream(folder_ / file) << text;
    }
    unsigned cores() const { return coresOfGroups(folder_ / "self", folder_ / "cgroup"); }
};

TEST_F(Cores, FollowTheQuotaOfTheGroupCountedUp) {
    write("self", "0::/pod/server\n");
    for (const auto& [text, expected] : {std::pair("max 100000\n", 0u),
                                         {"200000 100000\n", 2u},
                                         {"150000 100000\n", 2u},
                                         {"10000 100000\n", 1u},
                                         {"25000 50000\n", 1u},
                                         {"1600000 100000\n", 16u}}) {
        write("cgroup/pod/server/cpu.max", text);
        EXPECT_EQ(cores(), expected) << text;
    }
}

TEST_F(Cores, FollowTheLeastOfTheGroupsAround) {
    write("self", "0::/pod/server\n");
    write("cgroup/pod/server/cpu.max", "max 100000\n");
    write("cgroup/pod/cpu.max", "300000 100000\n");
    EXPECT_EQ(cores(), 3u);
    write("cgroup/cpu.max", "50000 100000\n");
    EXPECT_EQ(cores(), 1u);
    write("cgroup/pod/server/cpu.max", "800000 100000\n");
    EXPECT_EQ(cores(), 1u);
}

// As within a container: the group is the top of what is mounted.
TEST_F(Cores, FollowTheTopOfTheMountWhereThePathIsAnother) {
    write("self", "0::/\n");
    write("cgroup/cpu.max", "200000 100000\n");
    EXPECT_EQ(cores(), 2u);
    write("self", "0::/kubepods/burstable/pod1/abc\n");
    EXPECT_EQ(cores(), 2u);
}

TEST_F(Cores, FollowTheFirstVersionOfGroupsToo) {
    write("self", "12:memory:/docker/abc\n5:cpuset:/docker/abc\n4:cpu,cpuacct:/docker/abc\n0::/docker/abc\n");
    write("cgroup/cpu,cpuacct/docker/abc/cpu.cfs_quota_us", "-1\n");
    write("cgroup/cpu,cpuacct/docker/abc/cpu.cfs_period_us", "100000\n");
    EXPECT_EQ(cores(), 0u);
    write("cgroup/cpu,cpuacct/docker/abc/cpu.cfs_quota_us", "350000\n");
    EXPECT_EQ(cores(), 4u);
    write("cgroup/cpu,cpuacct/docker/cpu.cfs_quota_us", "100000\n");
    write("cgroup/cpu,cpuacct/docker/cpu.cfs_period_us", "100000\n");
    EXPECT_EQ(cores(), 1u);
}

TEST_F(Cores, AreUnboundWhereNothingOrNonsenseIsSaid) {
    EXPECT_EQ(cores(), 0u) << "no files";
    for (const char* self : {"", "0", "0:", "nonsense\n", "0::\n", "0::/pod\n", "4:cpuset:/pod\n"}) {
        write("self", self);
        EXPECT_EQ(cores(), 0u) << self;
    }
    write("self", "0::/pod\n");
    for (const char* text : {"", "max", "0 100000", "100000", "100000 0", "-5 100000", "words 100000"}) {
        write("cgroup/pod/cpu.max", text);
        EXPECT_EQ(cores(), 0u) << text;
    }
}

TEST_F(Cores, AreAtMostThoseThatTheProcessMayRunOn) {
    cpu_set_t before;
    ASSERT_EQ(::sched_getaffinity(0, sizeof before, &before), 0);
    EXPECT_GE(usableCores(), 1u);
    EXPECT_LE(usableCores(), unsigned(CPU_COUNT(&before)));
    cpu_set_t one;
    CPU_ZERO(&one);
    for (size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu)
        if (CPU_ISSET(cpu, &before) && CPU_COUNT(&one) == 0) CPU_SET(cpu, &one);
    ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(usableCores(), 1u);
    ASSERT_EQ(::sched_setaffinity(0, sizeof before, &before), 0);
}

} // namespace
} // namespace brume
