#include "defect_analysis/models/defect_labels.h"

#include <algorithm>
#include <charconv>

#include "scene/class_model.h"

namespace drupe {
namespace {

constexpr std::size_t kMaxBytes = 16 << 20;
constexpr std::string_view kNoDefect = "none";

Status Bad(int line, const std::string& what) {
  const std::string where = "line " + std::to_string(line);
  return InvalidArgument("bad_labels", "the labels' " + where + " " + what, where);
}

// The fields of a line; quotes around a field are taken off, doubled ones within become one.
std::vector<std::string> FieldsOf(std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"') {
        fields.back() += line[++i];
      } else {
        quoted = !quoted;
      }
    } else if (line[i] == separator && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  for (std::string& field : fields) {
    const auto last = field.find_last_not_of(" \t\r");
    field.erase(last == std::string::npos ? 0 : last + 1);
    field.erase(0, std::min(field.find_first_not_of(" \t"), field.size()));
  }
  return fields;
}

// The table's lines one after the other, without their ends; nothing at its end.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);  // a spreadsheet's mark of UTF-8
  }
  std::optional<std::string_view> Next() {
    if (text_.empty()) return std::nullopt;
    const std::size_t end = std::min(text_.find('\n'), text_.size());
    const std::string_view line = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    ++number_;
    return line;
  }
  int number() const { return number_; }

 private:
  std::string_view text_;
  int number_ = 0;
};

char SeparatorOf(std::string_view heading) {
  for (const char separator : {'\t', ';'}) {
    if (heading.find(separator) != std::string_view::npos) return separator;
  }
  return ',';
}

// Where a table has its columns; the field count where it has none.
struct Columns {
  std::size_t report, fruit, defect, defect_class;

  explicit Columns(const std::vector<std::string>& heading) {
    const auto place = [&](const char* name) {
      return static_cast<std::size_t>(std::find(heading.begin(), heading.end(), name) - heading.begin());
    };
    report = place("report");
    fruit = place("fruit");
    defect = place("defect");
    defect_class = place("class");
  }
};

// A number from 1 on; an empty field, or none, is 0.
std::optional<int> NumberOf(const std::vector<std::string>& fields, std::size_t column) {
  if (column >= fields.size() || fields[column].empty()) return 0;
  const std::string& text = fields[column];
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 1) return std::nullopt;
  return number;
}

Result<DefectLabel> ParseLabel(const std::vector<std::string>& fields, const Columns& columns, int line) {
  DefectLabel label{.report = "", .fruit = 0, .defect = 0, .defect_class = std::nullopt, .line = line};
  if (columns.report < fields.size()) label.report = fields[columns.report];
  const std::optional<int> fruit = NumberOf(fields, columns.fruit), defect = NumberOf(fields, columns.defect);
  if (!fruit) return Bad(line, "has a fruit that is no number from 1 on");
  if (!defect || *defect == 0) return Bad(line, "has a defect that is no number from 1 on");
  label.fruit = *fruit;
  label.defect = *defect;
  const std::string name = columns.defect_class < fields.size() ? fields[columns.defect_class] : "";
  if (name == kNoDefect) return label;
  label.defect_class = DefectClassOf(name);
  if (!label.defect_class) return Bad(line, "has a class other than rain_spot, scar, crack, decay or none");
  return label;
}

int NumberIn(const Json& object, const char* key) {
  if (!object.is_object()) return 0;
  const auto found = object.find(key);
  return found != object.end() && found->is_number_integer() ? found->get<int>() : 0;
}

// The list under `key` of an object, if it has one.
Json* ListIn(Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? &*found : nullptr;
}

bool IsOf(const DefectLabel& label, const std::string& report) {
  return label.report.empty() || label.report == report;
}

// The place of the defect that a label means in its fruit's list; nothing when there is no such defect.
struct DefectPlace {
  std::size_t fruit = 0, defect = 0;
};

std::optional<DefectPlace> Find(const DefectLabel& label, Json& fruits) {
  if (label.fruit == 0 && fruits.size() != 1) return std::nullopt;
  for (std::size_t f = 0; f < fruits.size(); ++f) {
    if (label.fruit != 0 && NumberIn(fruits[f], "id") != label.fruit) continue;
    const Json* defects = ListIn(fruits[f], "defects");
    for (std::size_t d = 0; defects != nullptr && d < defects->size(); ++d) {
      if (NumberIn((*defects)[d], "id") == label.defect) return DefectPlace{f, d};
    }
  }
  return std::nullopt;
}

}  // namespace

Result<std::vector<DefectLabel>> ParseDefectLabels(std::string_view csv) {
  if (csv.size() > kMaxBytes)
    return InvalidArgument("bad_labels", "the table of labels is larger than 16 MB", "labels");
  Lines lines(csv);
  const std::string_view heading = lines.Next().value_or("");
  const char separator = SeparatorOf(heading);
  const std::vector<std::string> names = FieldsOf(heading, separator);
  const Columns columns(names);
  if (columns.defect == names.size() || columns.defect_class == names.size()) {
    return Bad(1, "must name the columns, defect and class among them");
  }
  std::vector<DefectLabel> labels;
  while (const auto line = lines.Next()) {
    const std::vector<std::string> fields = FieldsOf(*line, separator);
    const bool empty = std::all_of(fields.begin(), fields.end(), [](const std::string& f) { return f.empty(); });
    // A report.csv has a line without a defect for an intact fruit.
    if (empty || (columns.defect < fields.size() && fields[columns.defect].empty())) continue;
    DRUPE_ASSIGN_OR_RETURN(DefectLabel label, ParseLabel(fields, columns, lines.number()));
    labels.push_back(std::move(label));
  }
  return labels;
}

Status LabelReport(const std::vector<DefectLabel>& labels, Json& report) {
  const std::string id = report.is_object() && report.contains("id") && report["id"].is_string()
                             ? report["id"].get<std::string>()
                             : std::string();
  Json* fruits = ListIn(report, "fruits");
  if (fruits == nullptr) return Status::Ok();  // ReadLabelledReport says what is wrong with it
  std::vector<Json> kept(fruits->size(), Json::array());
  for (const DefectLabel& label : labels) {
    if (!IsOf(label, id)) continue;
    const std::optional<DefectPlace> place = Find(label, *fruits);
    if (!place) {
      return Unprocessable("unknown_defect",
                           "the labels' line " + std::to_string(label.line) + " names no defect of report " + id);
    }
    if (!label.defect_class) continue;
    kept[place->fruit].push_back((*fruits)[place->fruit]["defects"][place->defect]);
    kept[place->fruit].back()["class"] = DefectClassName(*label.defect_class);
  }
  for (std::size_t f = 0; f < kept.size(); ++f) {
    if (Json* defects = ListIn((*fruits)[f], "defects")) *defects = std::move(kept[f]);
  }
  return Status::Ok();
}

}  // namespace drupe
