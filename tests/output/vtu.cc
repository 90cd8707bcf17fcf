// Boost 1.74's property tree notes its own use of bind otherwise.
#define BOOST_BIND_GLOBAL_PLACEHOLDERS
#include <selkie/base/exceptions.h>
#include <selkie/output/files.h>
#include <selkie/output/vtu.h>
#include <selkie/output/vtu_reader.h>

#include <boost/property_tree/xml_parser.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "../temporary_folder.h"
#include "block.h"

using namespace selkie;
using namespace selkie::test;

namespace
{
  using Tree = boost::property_tree::ptree;

  Tree
  read(const std::string &path)
  {
    Tree tree;
    boost::property_tree::read_xml(path, tree);
    return tree;
  }

  /// The files that a .pvd or .pvtu names.
  std::vector<std::string>
  listed(const std::string &path,
         const std::string &node,
         const char        *attribute)
  {
    std::vector<std::string> files;
    const Tree               tree = read(path);
    for (const auto &[name, child] : tree.get_child(node))
      if (child.count("<xmlattr>") == 1 &&
          child.get_child("<xmlattr>").count(attribute) == 1)
        files.push_back(
          child.get<std::string>("<xmlattr>." + std::string(attribute)));
    return files;
  }

  /// Sum of an attribute over all pieces of a .pvtu.
  unsigned long long
  count(const std::string &pvtu, const std::string &attribute)
  {
    unsigned long long sum    = 0;
    const auto         folder = std::filesystem::path(pvtu).parent_path();
    for (const std::string &piece :
         listed(pvtu, "VTKFile.PUnstructuredGrid", "Source"))
      {
        const Tree tree = read((folder / piece).string());
        for (const auto &[name, child] :
             tree.get_child("VTKFile.UnstructuredGrid"))
          if (name == "Piece")
            sum += child.get<unsigned long long>("<xmlattr>." + attribute);
      }
    return sum;
  }

  std::set<std::string>
  fields(const std::string &pvtu)
  {
    std::set<std::string> names;
    for (const std::string &name :
         listed(pvtu, "VTKFile.PUnstructuredGrid.PPointData", "Name"))
      names.insert(name);
    return names;
  }

  /// A folder with solution/.
  struct OutputFolder : TemporaryFolder
  {
    OutputFolder()
      : TemporaryFolder(MPI_COMM_WORLD)
    {
      std::filesystem::create_directories(path + "/solution");
      MPI_Barrier(MPI_COMM_WORLD);
    }
  };

  template <int dim>
  void
  check_particles(const Scene<dim> &scene, const bool with_solid)
  {
    const OutputFolder folder;
    Matter<dim>        matter(scene);
    VtuWriter<dim>     writer(folder.path, matter.particles);
    writer.write(0., 0, nullptr);
    writer.write(0.1, 7, nullptr);
    MPI_Barrier(MPI_COMM_WORLD);

    const auto files =
      listed(folder.path + "/particles.pvd", "VTKFile.Collection", "file");
    ASSERT_EQ(files.size(), 2u);
    const std::string last = folder.path + '/' + files[1];
    EXPECT_EQ(count(last, "NumberOfPoints"),
              matter.particles.handler().n_global_particles());
    const auto names = fields(last);
    for (const char *name : {"body", "id", "velocity", "volume ratio"})
      EXPECT_EQ(names.count(name), 1u) << name;
    for (const char *name : {"displacement", "Cauchy stress"})
      EXPECT_EQ(names.count(name), with_solid ? 1u : 0u) << name;
    EXPECT_FALSE(std::filesystem::exists(folder.path + "/mesh.pvd"));
  }
} // namespace

TEST(VtuMPI, Particles2D)
{
  check_particles<2>(two_blocks<2>(), true);
}

TEST(VtuMPI, Particles3D)
{
  check_particles<3>(two_blocks<3>(), true);
}

TEST(VtuMPI, FluidInOneCellLeavesRanksWithoutPoints)
{
  Scene<2> scene = two_blocks<2>();
  scene.bodies.erase(scene.bodies.begin());
  scene.bodies[0].shape =
    std::make_shared<Block<2>>(dealii::Point<2>(),
                               dealii::Point<2>(0.125, 0.125));
  check_particles<2>(scene, false);
}

TEST(VtuMPI, ReaderGetsBackWhatWasWritten)
{
  const OutputFolder folder;
  Matter<2>          matter(two_blocks<2>());
  matter.set_state(dealii::Tensor<1, 2>({0.3, -0.2}),
                   2.,
                   dealii::Tensor<2, 2>({{1.1, 0.2}, {0., 0.9}}),
                   0.95);
  VtuWriter<2> writer(folder.path, matter.particles);
  writer.write(0.25, 0, nullptr);
  MPI_Barrier(MPI_COMM_WORLD);

  const auto files = read_pvd(folder.path + "/particles.pvd");
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0].first, 0.25);
  const PointData data = read_points(files[0].second);
  ASSERT_EQ(data.positions.size(),
            matter.particles.handler().n_global_particles());

  const PointField *const id = data.find("id"), *v = data.find("velocity");
  const PointField *const F = data.find("deformation gradient");
  ASSERT_TRUE(id && v && F);
  EXPECT_EQ(v->unit, "m/s");
  EXPECT_EQ(data.find("no such field"), nullptr);
  std::map<double, std::size_t> places;
  for (std::size_t p = 0; p < data.positions.size(); ++p)
    places[(*id)(p)] = p;
  for (const auto &point : matter.particles.handler())
    {
      const std::size_t p = places.at(point.get_id());
      const auto velocity = matter.particles.columns.v(point.get_properties());
      const auto gradient = matter.particles.columns.F(point.get_properties());
      for (unsigned int i = 0; i < 2; ++i)
        {
          EXPECT_NEAR(data.positions[p][i], point.get_location()[i], 1e-7);
          EXPECT_NEAR((*v)(p, i), velocity[i], 1e-6);
          for (unsigned int j = 0; j < 2; ++j)
            EXPECT_NEAR((*F)(p, 3 * i + j), gradient[i][j], 1e-6);
        }
    }
}

TEST(VtuReader, NamesAFileThatIsCutOff)
{
  const OutputFolder folder;
  Matter<2>          matter(two_blocks<2>(), MPI_COMM_SELF);
  VtuWriter<2>       writer(folder.path, matter.particles);
  writer.write(0., 0, nullptr);
  const std::string piece = folder.path + "/solution/particles_0000.0.vtu";
  const std::string whole = read_text(piece);
  const auto        array = whole.find("AQAAA"); // its base64
  for (const std::string &text :
       {whole.substr(0, 2000),
        whole.substr(0, array + 40) + whole.substr(array + 48)})
    {
      write_text(piece, text);
      try
        {
          read_points(folder.path + "/solution/particles_0000.pvtu");
          ADD_FAILURE();
        }
      catch (const SceneError &error)
        {
          EXPECT_NE(std::string(error.what()).find(piece), std::string::npos);
        }
    }
}

TEST(VtuMPI, MeshHasNodalFields)
{
  const OutputFolder folder;
  Matter<2>          matter(two_blocks<2>());
  NodeCloud<2>       cloud(*matter.mesh, 3., 1e-6);

  using Field = NodalOutput<2>::Field;
  NodalOutput<2> output;
  output.cloud = &cloud;
  Field p(cloud.partitioner());
  for (unsigned int node = 0; node < cloud.n_owned(); ++node)
    p.local_element(node) = cloud.position(node)[0];
  p.update_ghost_values();
  output.scalars.emplace_back("pressure", p);
  output.vectors.emplace_back("velocity", std::array<Field, 2>{{p, p}});

  VtuWriter<2> writer(folder.path, matter.particles);
  writer.write(0., 0, &output);
  MPI_Barrier(MPI_COMM_WORLD);
  const auto files =
    listed(folder.path + "/mesh.pvd", "VTKFile.Collection", "file");
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(count(folder.path + '/' + files[0], "NumberOfCells"), 64u);
  const auto names = fields(folder.path + '/' + files[0]);
  EXPECT_EQ(names.size(), 2u);
  EXPECT_EQ(names.count("pressure") + names.count("velocity"), 2u);
}

TEST(VtuMPI, EachLayerOfNodesHasFieldsOfItsOwn)
{
  const OutputFolder folder;
  Matter<2>          matter(two_blocks<2>());
  NodeCloud<2>       cloud(*matter.mesh, 3., 1e-6, 2);

  using Field = NodalOutput<2>::Field;
  NodalOutput<2> output;
  output.cloud     = &cloud;
  const auto field = [&cloud](const double factor) {
    Field f(cloud.partitioner());
    for (unsigned int node = 0; node < cloud.n_owned(); ++node)
      f.local_element(node) =
        factor * cloud.position(node)[0] + 10. * cloud.layer(node);
    f.update_ghost_values();
    return f;
  };
  output.scalars.emplace_back("pressure", field(1.));
  output.vectors.emplace_back("velocity",
                              std::array<Field, 2>{{field(2.), field(3.)}});

  VtuWriter<2> writer(folder.path, matter.particles);
  writer.write(0., 0, &output);
  MPI_Barrier(MPI_COMM_WORLD);
  const auto files = read_pvd(folder.path + "/mesh.pvd");
  ASSERT_EQ(files.size(), 1u);
  const PointData data = read_points(files[0].second);
  EXPECT_GT(data.positions.size(), 0u);
  for (unsigned int l = 0; l < 2; ++l)
    {
      const std::string       which = "_of_layer_" + std::to_string(l);
      const PointField *const p     = data.find("pressure" + which);
      const PointField *const v     = data.find("velocity" + which);
      ASSERT_TRUE(p && v);
      for (std::size_t node = 0; node < data.positions.size(); ++node)
        {
          const double x = data.positions[node][0];
          EXPECT_NEAR((*p)(node), x + 10. * l, 1e-6);
          EXPECT_NEAR((*v)(node, 0), 2. * x + 10. * l, 1e-6);
          EXPECT_NEAR((*v)(node, 1), 3. * x + 10. * l, 1e-6);
        }
    }
}
