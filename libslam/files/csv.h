#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace slam::files {

/// Comma-separated values, record by record (RFC 4180). A field that begins with a double quote goes on to
/// the next one, over commas and line ends; a quote in it is written twice. Other quotes stand for
/// themselves. Lines end with \n or \r\n; the last one may have no end. An empty line is one empty field.
class CsvReader {
 public:
  /// path: what messages call the text. Both must live as long as the reader. first_line: where a part of a
  /// file begins.
  CsvReader(std::string_view text, const std::string& path, int first_line = 1)
      : text_(text), path_(path), next_line_(first_line) {}

  /// The next record into `fields`, whose memory is used again; false behind the last. Errors: InputError
  /// with path:line for a quoted field without an end.
  bool next(std::vector<std::string>& fields);

  /// Of the record that next() gave last: the line where it begins, "path:line"; its text, without
  /// the line's end.
  int line() const { return line_; }
  std::string place() const;
  std::string_view record() const { return text_.substr(begin_, end_ - begin_); }

 private:
  void readQuoted(std::string& field);
  void readPlain(std::string& field);
  /// Over the comma or the line's end behind a field; whether it was a comma.
  bool passSeparator();

  std::string_view text_;
  const std::string& path_;
  std::size_t at_ = 0, begin_ = 0, end_ = 0;
  int line_ = 0, next_line_;
};

/// The field as a finite number. Errors: InputError "place: found '...', expected a number".
double csvNumber(const std::string& field, const std::string& place);

/// Such a text with the names of its columns in its first record, by these names. Empty lines count for
/// nothing. Errors, all InputError with the path and where it can be said the line: an empty text; a record
/// with more or fewer fields than there are names; a column that is asked for and not there; no number.
class CsvTable {
 public:
  CsvTable(std::string_view text, std::string path);
  static CsvTable read(const std::string& path);  ///< the file; and the errors of readTextFile()

  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::vector<std::string>>& rows() const { return rows_; }
  int line(std::size_t row) const { return lines_[row]; }  ///< of the text, where the row begins
  bool has(const std::string& name) const { return columns_.count(name) > 0; }

  /// A column's fields, from the first row to the last; as numbers; as numbers with NaN for an empty field.
  std::vector<std::string> texts(const std::string& name) const;
  std::vector<double> numbers(const std::string& name) const { return numbers(name, false); }
  std::vector<double> numbersOrNan(const std::string& name) const { return numbers(name, true); }

 private:
  std::size_t columnOf(const std::string& name) const;
  std::vector<double> numbers(const std::string& name, bool may_lack) const;

  std::string path_;
  std::vector<std::string> names_;
  std::map<std::string, std::size_t> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<int> lines_;  ///< where each row begins
};

}  // namespace slam::files
