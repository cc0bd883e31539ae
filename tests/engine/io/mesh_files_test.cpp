// OBJ and PLY: the same mesh from every encoding, and files that lie.
#include <cmath>
#include <cstring>
#include <limits>

#include "io/scene_folder.h"

namespace fluxfarm {
namespace {

SceneDescription read_mesh(const SceneFolder& folder, const std::string& file, const std::string& bytes,
                           const std::string& more = "") {
  folder.write(file, bytes);
  const std::string type = file.substr(file.size() - 3);
  return folder.read_xml("<shape type=\"" + type + "\"><string name=\"filename\" value=\"" + file + "\"/>" + more + "</shape>");
}

void expect_vector(Vec3f actual, Vec3f expected, float tolerance = 1e-6f) {
  EXPECT_NEAR(actual.x, expected.x, tolerance);
  EXPECT_NEAR(actual.y, expected.y, tolerance);
  EXPECT_NEAR(actual.z, expected.z, tolerance);
}

// ---------------------------------------------------------------- OBJ

TEST(Obj, PolygonsBecomeFansAndGroupsAreIgnored) {
  const SceneFolder folder;
  const SceneDescription scene = read_mesh(folder, "a b.obj",
                                           "# a comment\nmtllib x.mtl\no thing\ng part\nusemtl red\ns 1\nv 0 0 0\nv 1 0 0\n"
                                           "v +1 1e0 0\nv 0 1 0\r\nf 1 2 3 4 # the square\n");
  EXPECT_EQ(only_mesh(scene).indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(only_mesh(scene).positions.size(), 4u);
}

TEST(Obj, NegativeIndicesCountBackFromTheNewest) {
  const SceneFolder folder;
  const SceneDescription scene = read_mesh(folder, "a.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\n");
  expect_vector(only_mesh(scene).positions[0], {0, 0, 0});
  expect_vector(only_mesh(scene).positions[2], {0, 1, 0});
}

TEST(Obj, CornersShareAVertexOnlyIfAllTheirIndicesAgree) {
  const SceneFolder folder;
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0.25\nvt 1 0\nvn 0 0 2\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/2/1 4/1/1\n";
  const SceneDescription scene = read_mesh(folder, "a.obj", text);
  EXPECT_EQ(only_mesh(scene).positions.size(), 5u);
  EXPECT_EQ(only_mesh(scene).indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 3, 4}));
  expect_vector(only_mesh(scene).normals[0], {0, 0, 1});
  EXPECT_FLOAT_EQ(only_mesh(scene).uvs[0].y, 0.75f) << "flip_tex_coords is on by default for OBJ";
}

TEST(Obj, MissingNormalsAreComputedByAngleAsInMitsuba) {
  const SceneFolder folder;
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.3 -0.2 1\nv 2 1 1\nf 1 2 3\nf 1 4 2\nf 2 5 3\n";
  const SceneDescription smooth = read_mesh(folder, "a.obj", text);
  // mi.load_dict({"type": "obj", ...}) of Mitsuba 3.6.4
  expect_vector(only_mesh(smooth).normals[0], {0, 0.56855208f, 0.82264727f}, 2e-6f);
  expect_vector(only_mesh(smooth).normals[1], {-0.27085444f, 0.13057736f, 0.95372295f}, 2e-6f);
  expect_vector(only_mesh(smooth).normals[2], {-0.22704610f, -0.22704610f, 0.94704807f}, 2e-6f);
  const SceneDescription flat = read_mesh(folder, "a.obj", text, "<boolean name=\"face_normals\" value=\"true\"/>");
  EXPECT_TRUE(only_mesh(flat).normals.empty());
}

// Mitsuba transforms the normals of a mirrored mesh with their side and shades by them; without normals the winding decides.
TEST(Obj, MirroredMeshesKeepTheSideOfTheirNormals) {
  const SceneFolder folder;
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";
  const std::string mirror = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
  const auto winding = [](const MeshDescription& mesh) {
    const auto& p = mesh.positions;
    return cross(p[mesh.indices[1]] - p[mesh.indices[0]], p[mesh.indices[2]] - p[mesh.indices[0]]).z;
  };
  const SceneDescription smooth = read_mesh(folder, "a.obj", text, mirror);
  expect_vector(only_mesh(smooth).normals[0], {0, 0, 1});
  EXPECT_GT(winding(only_mesh(smooth)), 0);
  const SceneDescription flat = read_mesh(folder, "a.obj", text, mirror + "<boolean name=\"face_normals\" value=\"true\"/>");
  EXPECT_LT(winding(only_mesh(flat)), 0);
}

TEST(Obj, BadLinesAreNamed) {
  const SceneFolder folder;
  const auto error = [&](const std::string& text) { return error_of([&] { read_mesh(folder, "m/a.obj", text); }); };
  EXPECT_EQ(error("v 0 0 0\nv 1 0\n"), "m/a.obj:2: the line ends early, expected another number");
  EXPECT_EQ(error("v 0 0 zero\n"), "m/a.obj:1: \"zero\", expected a finite number");
  EXPECT_EQ(error("v 0 0 nan\n"), "m/a.obj:1: \"nan\", expected a finite number");
  EXPECT_EQ(error("v 0 0 0\nv inf 0 0\n"), "m/a.obj:2: \"inf\", expected a finite number");
  EXPECT_EQ(error("v 0 0 0\nf 1 1 2\n"), "m/a.obj:2: the face refers to vertex 2, expected 1 to 1 or -1 to -1");
  EXPECT_EQ(error("v 0 0 0\nf 1 0 1\n"), "m/a.obj:2: the face refers to vertex 0, expected 1 to 1 or -1 to -1");
  EXPECT_EQ(error("v 0 0 0\nf 1//1 1 1\n"), "m/a.obj:2: the face refers to normal 1, expected 1 to 0 or -1 to -0");
  EXPECT_EQ(error("v 0 0 0\nf 1 1\n"), "m/a.obj:2: the face has 2 corners, expected at least 3");
  EXPECT_EQ(error("v 0 0 0\nf 1 x 1\n"), "m/a.obj:2: the face has \"x\", expected the index of a vertex");
  EXPECT_EQ(error(""), "m/a.obj: has no triangles");
}

// ---------------------------------------------------------------- checks of all meshes

TEST(Mesh, TrianglesWithoutAreaAreLeftOutWithAWarning) {
  const SceneFolder folder;
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\n";
  const SceneDescription scene = read_mesh(folder, "a.obj", vertices + "f 1 2 4\nf 1 2 3\nf 1 1 2\n");
  EXPECT_EQ(only_mesh(scene).indices.size(), 3u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0], "a.obj: 2 of 3 triangles have no area and were left out");
  EXPECT_EQ(error_of([&] { read_mesh(folder, "a.obj", vertices + "f 1 2 4\n"); }),
            "a.obj: all 1 triangles have no area, expected at least one that has");
  const std::string flatten = "<transform name=\"to_world\"><scale x=\"0\"/></transform>";
  EXPECT_EQ(error_of([&] { read_mesh(folder, "a.obj", vertices + "f 1 2 3\n", flatten); }),
            "a.obj: all 1 triangles have no area, expected at least one that has");
}

TEST(Mesh, CubeHasOutwardSides) {
  const SceneFolder folder;
  const SceneDescription scene = folder.read_xml("<shape type=\"cube\"/>");
  const MeshDescription& mesh = only_mesh(scene);
  EXPECT_EQ(mesh.positions.size(), 24u);
  ASSERT_EQ(mesh.indices.size(), 36u);
  for (std::size_t t = 0; t < 36; t += 3) {
    const Vec3f a = mesh.positions[mesh.indices[t]], b = mesh.positions[mesh.indices[t + 1]],
                c = mesh.positions[mesh.indices[t + 2]];
    const Vec3f n = cross(b - a, c - a);
    EXPECT_NEAR(length(n), 4, 1e-6f);
    EXPECT_GT(dot(n, a), 0);
    EXPECT_NEAR(dot(n, mesh.normals[mesh.indices[t]]), 4, 1e-6f);
  }
}

// ---------------------------------------------------------------- PLY

// Two triangles as a square with normals, texture coordinates, a property and an element that nobody knows.
std::string ply_header(const std::string& format, int vertices = 4, int faces = 1) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement unknown 2\nproperty list uchar short what\nelement vertex " +
         std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty double z\nproperty uchar red\nproperty float nx\nproperty float ny\n"
         "property float nz\nproperty float s\nproperty float t\nelement face " +
         std::to_string(faces) + "\nproperty list uchar ushort vertex_indices\nproperty int flags\nend_header\n";
}

class Bytes {
 public:
  explicit Bytes(bool big) : big_(big) {}
  template <typename Value>
  Bytes& add(Value value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    if (big_) std::reverse(bytes, bytes + sizeof value);
    text_.append(bytes, sizeof value);
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  bool big_;
  std::string text_;
};

constexpr float kCorners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

std::string binary_rows(bool big) {
  Bytes bytes(big);
  bytes.add(std::uint8_t{2}).add(std::int16_t{-1}).add(std::int16_t{7}).add(std::uint8_t{0});
  for (const auto& c : kCorners) {
    bytes.add(c[0]).add(c[1]).add(0.125).add(std::uint8_t{200}).add(0.0f).add(0.0f).add(2.0f).add(c[0]).add(c[1]);
  }
  bytes.add(std::uint8_t{4});
  for (std::uint16_t i = 0; i < 4; ++i) bytes.add(i);
  return bytes.add(std::int32_t{5}).text();
}

std::string ascii_rows() {
  std::string text = "2 -1 7\n0\n";
  for (const auto& c : kCorners) {
    const std::string xy = std::to_string(c[0]) + " " + std::to_string(c[1]);
    text += xy + " 0.125 200 0 0 2 " + xy + "\n";
  }
  return text + "4 0 1 2 3 5\n";
}

void expect_square(const MeshDescription& mesh) {
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  ASSERT_EQ(mesh.positions.size(), 4u);
  ASSERT_EQ(mesh.normals.size(), 4u);
  ASSERT_EQ(mesh.uvs.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    expect_vector(mesh.positions[i], {kCorners[i][0], kCorners[i][1], 0.125f});
    expect_vector(mesh.normals[i], {0, 0, 1});
    EXPECT_FLOAT_EQ(mesh.uvs[i].x, kCorners[i][0]);
    EXPECT_FLOAT_EQ(mesh.uvs[i].y, kCorners[i][1]);
  }
}

TEST(Ply, EveryEncodingGivesTheSameMesh) {
  const SceneFolder folder;
  expect_square(only_mesh(read_mesh(folder, "a.ply", ply_header("ascii") + ascii_rows())));
  expect_square(only_mesh(read_mesh(folder, "a.ply", ply_header("binary_little_endian") + binary_rows(false))));
  expect_square(only_mesh(read_mesh(folder, "a.ply", ply_header("binary_big_endian") + binary_rows(true))));
}

TEST(Ply, TruncatedDataIsAnErrorAtEveryLength) {
  const SceneFolder folder;
  for (const bool ascii : {true, false}) {
    const std::string header = ply_header(ascii ? "ascii" : "binary_little_endian");
    const std::string rows = ascii ? ascii_rows() : binary_rows(false);
    for (std::size_t kept = 0; kept + 2 < rows.size(); ++kept) {
      const std::string error = error_of([&] { read_mesh(folder, "a.ply", header + rows.substr(0, kept)); });
      EXPECT_EQ(error.find("a.ply: "), 0u) << error;
    }
  }
  const std::string whole = ply_header("binary_little_endian") + binary_rows(false);
  EXPECT_EQ(error_of([&] { read_mesh(folder, "a.ply", whole.substr(0, whole.size() - 1)); }),
            "a.ply: face 0: the file ends here, expected another number");
}

TEST(Ply, CountsThatTheFileCannotHoldAreErrorsBeforeMemoryIsTaken) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { read_mesh(folder, "a.ply", ply_header("binary_little_endian", 2000000000) + binary_rows(false)); }),
            "a.ply: unknown 1: the header promises 2000000000 rows of \"vertex\", but 161 bytes are left in the file; it is "
            "cut off or "
            "its header is wrong");
  const std::string list =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uint int vertex_indices\nend_header\n";
  Bytes bytes(false);
  bytes.add(0.0f).add(0.0f).add(0.0f).add(std::uint32_t{4000000000u}).add(std::int32_t{0});
  EXPECT_EQ(error_of([&] { read_mesh(folder, "a.ply", list + bytes.text()); }),
            "a.ply: face 0: list \"vertex_indices\" has a length of 4e+09, but 4 bytes are left in the file");
}

TEST(Ply, WrongIndicesAndNumbersAreErrors) {
  const SceneFolder folder;
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const auto error = [&](const std::string& rows) { return error_of([&] { read_mesh(folder, "a.ply", header + rows); }); };
  EXPECT_EQ(error("0 0 0 1 0 0 0 1 0 3 0 1 3"), "a.ply: face 0: refers to vertex 3, expected an index from 0 to 2");
  EXPECT_EQ(error("0 0 0 1 0 0 0 1 0 3 0 1 -1"), "a.ply: face 0: refers to vertex -1, expected an index from 0 to 2");
  EXPECT_EQ(error("0 0 0 1 0 0 0 1 0 2 0 1"), "a.ply: face 0: has 2 corners, expected at least 3");
  EXPECT_EQ(error("0 0 0 1 0 nan 0 1 0 3 0 1 2"),
            "a.ply: vertex 1 is (1, 0, nan), in the world (nan, nan, nan), expected finite numbers");
  EXPECT_EQ(error("0 0 0 1 0 0 0 -inf 0 3 0 1 2").find("a.ply: vertex 2 is (0, -inf, 0)"), 0u);
  EXPECT_EQ(error("0 0 0 1 0 0 0 x 0 3 0 1 2"), "a.ply: vertex 2: \"x\", expected a number");
}

TEST(Ply, BadHeadersAreErrors) {
  const SceneFolder folder;
  const auto error = [&](const std::string& bytes) { return error_of([&] { read_mesh(folder, "a.ply", bytes); }); };
  EXPECT_EQ(error("plyy\n"), "a.ply:1: bad PLY header: expected \"ply\"");
  EXPECT_EQ(error("ply\nformat ascii 1.0\n"), "a.ply:3: bad PLY header: the file ends before end_header");
  EXPECT_EQ(error("ply\nformat ascii 1.0\nelement vertex -1\n"),
            "a.ply:3: bad PLY header: expected \"element NAME COUNT\" with a count of at least 0");
  EXPECT_EQ(error("ply\nend_header\n"), "a.ply:2: bad PLY header: the header has no format");
  EXPECT_EQ(error("ply\nformat ascii 1.0\nelement face 0\nend_header\n"), "a.ply: has no vertices");
  EXPECT_EQ(error("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
            "a.ply: the vertices lack x, y or z");
}

TEST(Ply, ElementsWithoutPropertiesTakeNoTime) {
  const SceneFolder folder;
  const std::string bytes =
      "ply\nformat ascii 1.0\nelement nothing 4000000000\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
      "0 0 0 1 0 0 0 1 0 3 0 1 2\n";
  EXPECT_EQ(only_mesh(read_mesh(folder, "a.ply", bytes)).indices.size(), 3u);
}

}  // namespace
}  // namespace fluxfarm
