// Boost 1.74's property tree notes its own use of bind otherwise.
#define BOOST_BIND_GLOBAL_PLACEHOLDERS
#include <selkie/base/exceptions.h>
#include <selkie/output/vtu_reader.h>

#include <deal.II/base/utilities.h>

#include <boost/property_tree/xml_parser.hpp>

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <sstream>

namespace selkie
{
  namespace
  {
    using XmlTree = boost::property_tree::ptree;

    /// Does `use` with the XML tree of a file; what goes wrong becomes a
    /// SceneError that names it.
    template <typename Use>
    void
    with_xml(const std::string &path, const Use &use)
    {
      try
        {
          XmlTree tree;
          boost::property_tree::read_xml(path, tree);
          use(tree);
        }
      catch (const SceneError &) // of a file that this one names
        {
          throw;
        }
      catch (const std::exception &error)
        {
          throw SceneError("the file '" + path +
                           "' cannot be used: " + error.what());
        }
    }

    std::string
    attribute(const XmlTree     &node,
              const std::string &name,
              const std::string &otherwise = "")
    {
      return node.get<std::string>("<xmlattr>." + name, otherwise);
    }

    /// A file that the file `from` names.
    std::string
    beside(const std::string &from, const std::string &name)
    {
      return (std::filesystem::path(from).parent_path() / name).string();
    }

    /// The bytes of a compressed array: in base64 a header of four integers
    /// (number of blocks, here 1; size of a block, of the last block, and of
    /// its compressed form), then, in base64 of its own, the block.
    std::vector<unsigned char>
    decompress_block(const std::string &text)
    {
      constexpr std::size_t header_bytes = 4 * sizeof(std::uint32_t);
      constexpr std::size_t header_chars = (header_bytes + 2) / 3 * 4;
      std::uint32_t         header[4];
      const auto            begin =
        dealii::Utilities::decode_base64(text.substr(0, header_chars));
      if (begin.size() != header_bytes)
        throw std::runtime_error("an array is cut off");
      std::memcpy(header, begin.data(), header_bytes);
      if (header[0] != 1)
        throw std::runtime_error("an array has several blocks");

      const auto packed =
        dealii::Utilities::decode_base64(text.substr(header_chars));
      std::vector<unsigned char> bytes(header[1]);
      uLongf                     size = bytes.size();
      if (packed.size() < header[3] ||
          uncompress(bytes.data(), &size, packed.data(), header[3]) != Z_OK ||
          size != bytes.size())
        throw std::runtime_error("an array cannot be decompressed");
      return bytes;
    }

    /// The numbers of a text, or of a compressed array.
    template <typename Number>
    std::vector<double>
    decode_numbers(const std::string &text, const bool ascii)
    {
      if (ascii)
        {
          std::istringstream stream(text);
          return {std::istream_iterator<double>(stream), {}};
        }
      const auto          bytes = decompress_block(text);
      std::vector<Number> numbers(bytes.size() / sizeof(Number));
      std::memcpy(numbers.data(),
                  bytes.data(),
                  numbers.size() * sizeof(Number));
      return {numbers.begin(), numbers.end()};
    }

    PointField
    read_array(const XmlTree &node, const std::size_t n_points)
    {
      PointField field;
      field.name         = attribute(node, "Name");
      field.unit         = attribute(node, "units");
      field.n_components = node.get("<xmlattr>.NumberOfComponents", 1u);

      const std::string type   = attribute(node, "type");
      const std::string format = attribute(node, "format");
      const std::string text   = dealii::Utilities::trim(node.data());
      if ((type != "Float32" && type != "Float64") ||
          (format != "binary" && format != "ascii"))
        throw std::runtime_error("an array is " + type + " in " + format);
      field.values = type == "Float32"
                       ? decode_numbers<float>(text, format == "ascii")
                       : decode_numbers<double>(text, format == "ascii");
      if (field.values.size() != n_points * field.n_components)
        throw std::runtime_error("the array '" + field.name + "' has " +
                                 std::to_string(field.values.size()) +
                                 " numbers for " + std::to_string(n_points) +
                                 " points");
      return field;
    }

    /// Adds the fields of a piece to those of the pieces before, which have
    /// the same ones in the same order.
    void
    append_fields(const XmlTree &piece, const std::size_t n, PointData &data)
    {
      const bool  first = data.fields.empty();
      std::size_t next  = 0;
      for (const auto &[name, node] : piece.get_child("PointData"))
        if (name == "DataArray")
          {
            PointField field = read_array(node, n);
            if (first)
              {
                data.fields.push_back(field);
                continue;
              }
            if (next >= data.fields.size() ||
                data.fields[next].name != field.name)
              throw std::runtime_error("its pieces have different arrays");
            auto &values = data.fields[next++].values;
            values.insert(values.end(),
                          field.values.begin(),
                          field.values.end());
          }
    }

    void
    append_piece(const XmlTree &piece, PointData &data)
    {
      const auto n = piece.get<std::size_t>("<xmlattr>.NumberOfPoints");
      if (n == 0) // a rank without points
        return;
      const PointField x = read_array(piece.get_child("Points.DataArray"), n);
      if (x.n_components != 3)
        throw std::runtime_error("positions do not have 3 coordinates");
      for (std::size_t i = 0; i < n; ++i)
        data.positions.emplace_back(x(i, 0), x(i, 1), x(i, 2));
      append_fields(piece, n, data);
    }

    void
    append_vtu(const std::string &path, PointData &data)
    {
      with_xml(path, [&](const XmlTree &tree) {
        const XmlTree &file = tree.get_child("VTKFile");
        if (attribute(file, "byte_order") != "LittleEndian" ||
            attribute(file, "header_type", "UInt32") != "UInt32")
          throw std::runtime_error("its bytes are ordered otherwise");
        for (const auto &[name, node] : file.get_child("UnstructuredGrid"))
          if (name == "Piece")
            append_piece(node, data);
      });
    }
  } // namespace


  const PointField *
  PointData::find(const std::string &name) const
  {
    for (const PointField &field : fields)
      if (field.name == name)
        return &field;
    return nullptr;
  }


  std::vector<std::pair<double, std::string>>
  read_pvd(const std::string &path)
  {
    std::vector<std::pair<double, std::string>> files;
    with_xml(path, [&](const XmlTree &tree) {
      for (const auto &[name, node] : tree.get_child("VTKFile.Collection"))
        if (name == "DataSet")
          files.emplace_back(node.get<double>("<xmlattr>.timestep"),
                             beside(path, attribute(node, "file")));
    });
    return files;
  }


  PointData
  read_points(const std::string &pvtu)
  {
    PointData data;
    with_xml(pvtu, [&](const XmlTree &tree) {
      for (const auto &[name, node] :
           tree.get_child("VTKFile.PUnstructuredGrid"))
        if (name == "Piece")
          append_vtu(beside(pvtu, attribute(node, "Source")), data);
    });
    return data;
  }
} // namespace selkie
