#include "tools/studies/counts/results.h"

#include <filesystem>
#include <string>

#include "tests/expect.h"
#include "tests/tools/studies/counts/sample.h"
#include "tools/studies/counts/count.h"

namespace slipbench::counts {
namespace {

// 1,000 instructions in 4 s are 0.00025 million a second: an axis from 1e-4 to 1e-3, log10(2.5) = 0.398 of its 238 pixels. 8
// times real time: from 1 to 10, log10(8) = 0.903 of 233.
TEST(BenchDrawing, BarsAsLongAsTheirLogarithms) {
  const std::string svg = drawing(sample_results());
  EXPECT_THAT(svg, HasSubstr("<rect class=\"bar s0\" x=\"150\" y=\"51\" width=\"94.7\""));
  EXPECT_THAT(svg, HasSubstr("<rect class=\"bar s2\" x=\"460\" y=\"51\" width=\"210.4\""));
  EXPECT_THAT(svg, HasSubstr(">0.00025</text>"));
  EXPECT_THAT(svg, HasSubstr(">8</text>"));
  EXPECT_THAT(svg, HasSubstr(">papillarray/stage</text>"));
}

TEST(BenchDrawing, TextIsEscapedAndBuildAndMachineAreThere) {
  const std::string svg = drawing(sample_results());
  EXPECT_THAT(svg, HasSubstr("GNU 12.2.0, x86_64 with AVX2"));
  EXPECT_THAT(svg, HasSubstr("A &lt;fast&gt; one &amp; two, 0123456789ab"));
  EXPECT_THAT(svg, Not(HasSubstr("<fast>")));
}

TEST(BenchDrawing, ABarOfAPowerOfTenHasALength) {
  Results results = sample_results();
  results.scenes[0].cpu_time = 0.4;  // 10 times real time
  EXPECT_THAT(drawing(results), HasSubstr("<rect class=\"bar s2\" x=\"460\" y=\"51\" width=\"233\""));
}

// What is committed belongs together: results that can be read, of the scenes that are counted, one file a build, each with its
// drawing.
TEST(BenchDrawing, CommittedDrawingsAreOfTheCommittedResults) {
  const std::filesystem::path folder = SLIPBENCH_SOURCE_DIR "/tests/benchmarks/results";
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    ++files;
    const std::string path = entry.path().string();
    const Results results = read_results(path);
    EXPECT_EQ(find_results(folder.string(), results.build), path);
    EXPECT_NO_THROW(check_comparable(results, results.build, path));
    EXPECT_EQ(results_json(results), file_text(path)) << path << " was changed by hand";
    EXPECT_TRUE(drawing(results) == file_text(std::filesystem::path(path).replace_extension(".svg")))
        << path << " has another drawing: slipbench bench -o writes both";
  }
  EXPECT_GT(files, 0U);
}

}  // namespace
}  // namespace slipbench::counts
