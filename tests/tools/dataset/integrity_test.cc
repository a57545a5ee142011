// Coverage of the digests, and refusals before reading.
#include <sys/stat.h>

#include <functional>
#include <new>

#include <hdf5.h>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/content_check.h"
#include "tools/dataset/record/content_digest.h"
#include "tools/dataset/writer.h"

namespace slipbench::testing::integrity_test {
namespace {

const DatasetHeader header{"1.2.3", "scene", "{}", 7, "slipbench sweep a.yaml"};
constexpr std::size_t rows = 40;

// Replaces the first float64 or text value of an attribute or array.
void change_attribute(hid_t file, const std::string& object, const std::string& name, double value) {
  const hid_t holder = H5Oopen(file, object.c_str(), H5P_DEFAULT), attribute = H5Aopen(holder, name.c_str(), H5P_DEFAULT);
  const std::vector<double> values(static_cast<std::size_t>(H5Aget_storage_size(attribute)) / 8, value);
  EXPECT_GE(H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data()), 0);
  H5Aclose(attribute);
  H5Oclose(holder);
}

void change_text(hid_t file, const std::string& object, const std::string& name, const char* text) {
  const hid_t holder = H5Oopen(file, object.c_str(), H5P_DEFAULT), attribute = H5Aopen(holder, name.c_str(), H5P_DEFAULT);
  const hid_t type = H5Aget_type(attribute);
  EXPECT_GE(H5Awrite(attribute, type, &text), 0);
  H5Tclose(type);
  H5Aclose(attribute);
  H5Oclose(holder);
}

struct IntegrityTest : FolderTest {
  IntegrityTest() {
    DatasetWriter writer(path("a.h5"), header);
    for (std::size_t k = 0; k < 3; ++k) writer.append(make_trial(k, rows));
    writer.commit();
  }
  // Expects each change alone to be found.
  void expect_found(const std::vector<std::function<void(hid_t)>>& changes, const std::string& message) const {
    for (std::size_t i = 0; i < changes.size(); ++i) {
      const std::string whole = bytes_of(path("a.h5"));
      change(changes[i]);
      EXPECT_THAT(refusal_of([&] { check(); }), HasSubstr(message)) << i;
      std::ofstream(path("a.h5"), std::ios::binary) << whole;
    }
  }
  void change(const std::function<void(hid_t)>& action) const {
    const hid_t file = H5Fopen(path("a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    action(file);
    H5Fclose(file);
  }
  void check() const {
    const DatasetReader reader(path("a.h5"));
    check_content(reader);
  }
  [[nodiscard]] std::string refusal() const {
    return refusal_of([&] {
      const DatasetReader reader(path("a.h5"));
      for (const std::size_t trial : reader.trials()) static_cast<void>(reader.read_trial(trial));
      check_content(reader);
    });
  }
};

TEST_F(IntegrityTest, WholeFileHolds) { EXPECT_NO_THROW(check()); }

// The reproducer: changed onset times of all units, which report and every export accepted
// silently.
TEST_F(IntegrityTest, AttributeOfATrialIsCovered) {
  change([](hid_t file) { change_attribute(file, "/data/demo_1/labels/pad", "onset_time_s", 1.2345); });
  EXPECT_THAT(refusal_of([&] { check(); }), mentions({"a.h5", "/data/demo_1", "SHA-256"}));
}

TEST_F(IntegrityTest, EveryKindOfValueOfATrialIsCovered) {
  const std::vector<std::function<void(hid_t)>> changes{
      [](hid_t file) { change_text(file, "/data/demo_0", "params", "{}"); },
      [](hid_t file) { change_text(file, "/data/demo_0/labels/pad/force", "unit", "kN"); },
      [](hid_t file) { change_text(file, "/data/demo_0/labels/pad/unit_state", "codes", "{}"); },
      [](hid_t file) { change_attribute(file, "/data/demo_0/sensors/pad", "rate_hz", 999.0); },
      [](hid_t file) { H5Adelete_by_name(file, "/data/demo_0/labels/pad", "unit_heights", H5P_DEFAULT); },
      [](hid_t file) { H5Arename_by_name(file, "/data/demo_0/labels/pad", "k_normal", "k_normals", H5P_DEFAULT); },
      [](hid_t file) { H5Ldelete(file, "/data/demo_0/labels/pad/margin", H5P_DEFAULT); },
      [](hid_t file) {
        H5Lmove(file, "/data/demo_0/truth/pad/pose", file, "/data/demo_0/truth/pad/poses", H5P_DEFAULT, H5P_DEFAULT);
      },
  };
  expect_found(changes, "/data/demo_0: is damaged");
}

TEST_F(IntegrityTest, WhatStandsBesideTheTrialsIsCovered) {
  const std::vector<std::function<void(hid_t)>> changes{
      [](hid_t file) { change_text(file, "/", "scene", "another"); },
      [](hid_t file) { change_text(file, "/", "command", "another"); },
      [](hid_t file) { change_text(file, "/mask", "rule", "another"); },
      [](hid_t file) { H5Ldelete(file, "/mask/valid", H5P_DEFAULT); },
      [](hid_t file) { H5Lmove(file, "/data/demo_2", file, "/data/demo_3", H5P_DEFAULT, H5P_DEFAULT); },
      [](hid_t file) { H5Ldelete(file, "/data/demo_2", H5P_DEFAULT); },
  };
  expect_found(changes, "a.h5: is damaged: its content has the SHA-256 ");
}

// A file as version 1 wrote it: no digests of trials, no codes, only arrays in content_sha256.
TEST_F(IntegrityTest, SchemaOneHasItsArraysChecked) {
  change([&](hid_t file) {
    std::vector<Digest> digests;
    for (const char* demo : {"/data/demo_0", "/data/demo_1", "/data/demo_2"}) {
      H5Adelete_by_name(file, demo, "sha256", H5P_DEFAULT);
      digests.push_back(stored_arrays_digest({file, path("a.h5"), demo}));
    }
    change_text(file, "/", "content_sha256", content_digest(digests).c_str());
    const hid_t schema = H5Aopen(file, "schema", H5P_DEFAULT);
    const std::uint64_t one = 1;
    EXPECT_GE(H5Awrite(schema, H5T_NATIVE_UINT64, &one), 0);
    H5Aclose(schema);
  });
  ::testing::internal::CaptureStderr();
  EXPECT_NO_THROW(check());
  const std::string said = ::testing::internal::GetCapturedStderr();
  // This digest identifies a detector's training data.
  {
    const DatasetReader reader(path("a.h5"));
    EXPECT_EQ(trial_identity(reader, 1), hexadecimal(reader.stored_digest(1)));
    EXPECT_NE(trial_identity(reader, 1), trial_identity(reader, 2));
  }
  EXPECT_EQ(said, "slipbench: " + path("a.h5") +
                      ": schema 1: its digest covers only the arrays, so attributes such as onset_time_s are not checked\n");
  change([](hid_t file) {
    const hid_t array = H5Dopen2(file, "/data/demo_1/labels/pad/margin", H5P_DEFAULT);
    const std::vector<float> other(rows * 2, 0.5F);
    EXPECT_GE(H5Dwrite(array, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, other.data()), 0);
    H5Dclose(array);
  });
  EXPECT_THAT(refusal_of([&] { check(); }), mentions({"damaged", "SHA-256"}));
}

TEST_F(IntegrityTest, WhatLiesInOtherFilesIsRefused) {
  const auto without = [&](const std::string& object, const std::function<void(hid_t)>& action) {
    const std::string whole = bytes_of(path("a.h5"));
    change([&](hid_t file) {
      H5Ldelete(file, object.c_str(), H5P_DEFAULT);
      action(file);
    });
    const std::string message = refusal();
    std::ofstream(path("a.h5"), std::ios::binary) << whole;
    return message;
  };
  const std::string margin = "/data/demo_1/labels/pad/margin";
  EXPECT_THAT(without("/data/demo_1/labels",
                      [](hid_t file) {
                        H5Lcreate_external("other.h5", "/data/demo_0/labels", file, "/data/demo_1/labels", H5P_DEFAULT,
                                           H5P_DEFAULT);
                      }),
              HasSubstr("/data/demo_1/labels: is a link to another file"));
  EXPECT_THAT(without(margin,
                      [&](hid_t file) {
                        H5Lcreate_soft("/data/demo_0/labels/pad/margin", file, margin.c_str(), H5P_DEFAULT, H5P_DEFAULT);
                      }),
              HasSubstr(margin + ": is a link to another file"));
  EXPECT_THAT(
      without("/data/demo_1", [](hid_t file) { H5Lcreate_soft("/data/demo_0", file, "/data/demo_1", H5P_DEFAULT, H5P_DEFAULT); }),
      HasSubstr("/data/demo_1: is a link to another file"));

  const hsize_t extents[2] = {rows, 2};
  const hid_t space = H5Screate_simple(2, extents, nullptr);
  EXPECT_THAT(without(margin,
                      [&](hid_t file) {
                        const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
                        H5Pset_external(properties, "/etc/passwd", 0, rows * 2 * 4);
                        H5Dclose(H5Dcreate2(file, margin.c_str(), H5T_IEEE_F32LE, space, H5P_DEFAULT, properties, H5P_DEFAULT));
                        H5Pclose(properties);
                      }),
              HasSubstr(margin + ": has its values in another file"));
  EXPECT_THAT(without(margin,
                      [&](hid_t file) {
                        const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
                        H5Pset_virtual(properties, space, "other.h5", "/values", space);
                        H5Dclose(H5Dcreate2(file, margin.c_str(), H5T_IEEE_F32LE, space, H5P_DEFAULT, properties, H5P_DEFAULT));
                        H5Pclose(properties);
                      }),
              HasSubstr(margin + ": is a virtual dataset with values in other files"));
  H5Sclose(space);
}

// 16 TB declared, nothing stored.
TEST_F(IntegrityTest, DeclaredSizeIsCheckedBeforeMemoryIsTaken) {
  change([](hid_t file) {
    H5Ldelete(file, "/data/demo_1/labels/pad/margin", H5P_DEFAULT);
    const hsize_t extents[2] = {hsize_t{1} << 41, 2}, chunk[2] = {100, 2};
    const hid_t space = H5Screate_simple(2, extents, nullptr), properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(properties, 2, chunk);
    H5Pset_deflate(properties, 4);
    H5Dclose(H5Dcreate2(file, "/data/demo_1/labels/pad/margin", H5T_IEEE_F32LE, space, H5P_DEFAULT, properties, H5P_DEFAULT));
    H5Pclose(properties);
    H5Sclose(space);
  });
  EXPECT_THAT(
      refusal(),
      AllOf(HasSubstr(
          "/data/demo_1/labels/pad/margin: its extents [2199023255552, 2] are larger than a file of this size can contain")));
}

TEST_F(IntegrityTest, NamesWithControlCharactersAreRefused) {
  change([](hid_t file) {
    H5Lmove(file, "/data/demo_1/sensors/pad", file, "/data/demo_1/sensors/p\x1b[31m", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_THAT(refusal(), mentions({"/data/demo_1/sensors", "p\\x1b[31m"}));
}

TEST_F(IntegrityTest, PipeIsRefused) {
  ASSERT_EQ(::mkfifo(path("pipe.h5").c_str(), 0600), 0);
  EXPECT_THAT(refusal_of([&] { DatasetReader reader(path("pipe.h5")); }), mentions({"pipe.h5", "a pipe"}));
}

}  // namespace
}  // namespace slipbench::testing::integrity_test
