#include "tests/integration/program.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

namespace brume::test {

std::unique_ptr<Process> startProgram(const std::string& program, const std::vector<std::string>& arguments,
                                      const std::vector<std::string>& environment) {
    std::vector<std::string> command{program};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return std::make_unique<Process>(command, environment);
}

size_t timesIn(const std::string& text, const std::string& words) {
    size_t count = 0;
    for (size_t at = 0; (at = text.find(words, at)) != text.npos; at += words.size()) ++count;
    return count;
}

client::Bytes contentOf(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void expectOneLine(Process& process, const std::string& words) {
    SCOPED_TRACE(words);
    const auto code = process.exitCode();
    ASSERT_TRUE(code) << "it goes on";
    EXPECT_GT(*code, 0) << "exited with 0 or was ended by a signal";
    const std::string err = process.err();
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    EXPECT_NE(err.find(words), err.npos) << err;
}

} // namespace brume::test
