// The times of a shader's operations.
#include "tools/bench/operations/operations.h"

#include <sstream>

#include <gtest/gtest.h>

#include "tests/layer.h"

namespace brume::bench::operations_test {
namespace {

TEST(Operations, EachHasATimeAndBreaksNoRule) {
    BRUME_WHOLE_LAYER_ONLY();
    const gpu::Device device({.validation = true});
    std::istringstream table(operationsTable(device, 1));
    std::string row, cell;
    std::getline(table, row);
    std::getline(table, row); // the head and the line below it
    size_t rows = 0;
    for (; std::getline(table, row); ++rows) {
        std::istringstream cells(row);
        std::getline(cells, cell, '|');
        std::getline(cells, cell, '|'); // the operation
        std::getline(cells, cell, '|');
        EXPECT_GT(std::stod(cell), 0) << row;
    }
    EXPECT_GT(rows, 30u);
    EXPECT_EQ(device.validationMessages(), 0u);
}

} // namespace
} // namespace brume::bench::operations_test
