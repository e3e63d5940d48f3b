// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What ThreadSanitizer has to see, and what it must not: a flow graph whose node bodies count in a
// plain number, which is a race made on purpose ("seeded"), and the same graph with an atomic one
// ("clean"). With an oneTBB that is not instrumented both are full of reports, and a suppression
// that silences these hides the seeded one: the two tests hold the setup of the preset `tsan`.
#include <tbb/flow_graph.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstdio>
#include <string_view>

#include "tests/meeting.h"

namespace {

constexpr int kMessages = 64;

template <typename Counter>
int count_messages(Counter& counter) {
    psfm::testing::Meeting meeting;
    tbb::task_arena arena(4);
    arena.execute([&] {
        tbb::flow::graph graph;
        tbb::flow::function_node<int, int> first(graph, tbb::flow::unlimited, [&](int message) {
            meeting.wait();
            ++counter;
            return message;
        });
        tbb::flow::function_node<int, tbb::flow::continue_msg> second(
            graph, tbb::flow::serial, [](int) { return tbb::flow::continue_msg{}; });
        tbb::flow::make_edge(first, second);
        for (int i = 0; i < kMessages; ++i) first.try_put(i);
        graph.wait_for_all();
    });
    return counter;
}

}  // namespace

int main(int argc, char** argv) {
    const bool seeded = argc == 2 && std::string_view(argv[1]) == "seeded";
    int plain = 0;
    std::atomic<int> atomic{0};
    std::printf("%d of %d messages counted\n",
                seeded ? count_messages(plain) : count_messages(atomic), kMessages);
    return 0;
}
