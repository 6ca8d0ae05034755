// Writes the example messages and what they say. Only for new messages: an example that is released never changes.
#include <fstream>
#include <iostream>

#include <nlohmann/json.hpp>

#include "tests/unit/protocol_examples.h"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: write_protocol_examples protocol/examples\n";
        return 2;
    }
    const std::string folder = argv[1];
    std::ofstream expected(folder + "/examples.json");
    const char* separator = "{\n";
    for (const auto& example : brume::wire::makeExamples()) {
        std::ofstream file(folder + "/" + example.name + ".bin", std::ios::binary);
        file.write(reinterpret_cast<const char*>(example.bytes.data()), std::streamsize(example.bytes.size()));
        const auto parsed = brume::wire::parse(example.bytes);
        if (!parsed || !file.flush()) {
            std::cerr << "cannot write " << example.name << '\n';
            return 1;
        }
        expected << separator << "  \"" << example.name << "\": " << describe(*parsed).dump();
        separator = ",\n";
    }
    expected << "\n}\n";
    return expected.flush() ? 0 : 1;
}
