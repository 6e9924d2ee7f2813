/* config_file.cpp - see config_file.h. The one C++ file of the tools: a C face on toml++. */
#include "config_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iostream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/* toml++ asserts in places that a text can reach (a line "[" for one): what it did not expect is no TOML. It would let the
 * compiler assume the opposite where NDEBUG is set. */
[[noreturn]] static void not_toml()
{
    throw std::logic_error("not TOML");
}
#undef NDEBUG
#define TOML_ASSERT(expression) ((expression) ? static_cast<void>(0) : not_toml())
#include <toml++/toml.h>

struct config_file_t {
    std::string name;
    toml::table root;
    std::set<std::string> known;       /* every path asked for, and the tables on the way to it */
    std::set<std::string> allowed;     /* whole tables */
    std::vector<std::string> problems; /* wrong types and complaints, in the order found */
};

namespace {

void put(char *out, size_t cap, const std::string &text)
{
    if (out == nullptr || cap == 0) { return; }
    const size_t n = std::min(cap - 1, text.size());
    std::memcpy(out, text.data(), n);
    out[n] = '\0';
}

std::string place(const config_file_t &c, const toml::node &node)
{
    return c.name + ":" + std::to_string(node.source().begin.line) + ": ";
}

/* "a.b[2].c" makes known: a, a.b, a.b[2], a.b[2].c */
void make_known(config_file_t &c, const std::string &path)
{
    for (size_t i = 1; i < path.size(); i++) {
        if (path[i] == '.' || path[i] == '[') { c.known.insert(path.substr(0, i)); }
    }
    c.known.insert(path);
}

const toml::node *find(config_file_t &c, const char *path)
{
    make_known(c, path);
    return c.root.at_path(path).node();
}

void wrong_type(config_file_t &c, const char *path, const toml::node &node, const char *wanted)
{
    c.problems.push_back(place(c, node) + "'" + path + "' must be " + wanted);
}

size_t edit_distance(const std::string &a, const std::string &b)
{
    std::vector<size_t> row(b.size() + 1);
    for (size_t j = 0; j <= b.size(); j++) { row[j] = j; }
    for (size_t i = 1; i <= a.size(); i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b.size(); j++) {
            const size_t substituted = diagonal + ((a[i - 1] == b[j - 1]) ? 0u : 1u);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
        }
    }
    return row[b.size()];
}

/* The key of the same table that was asked for and is spelt most like this one; "" if none is near. */
std::string nearest(const config_file_t &c, const std::string &parent, const std::string &key)
{
    const std::string prefix = parent.empty() ? "" : parent + ".";
    std::string best;
    size_t best_distance = std::max<size_t>(2, key.size() / 3) + 1;
    for (const std::string &path : c.known) {
        if (path.compare(0, prefix.size(), prefix) != 0) { continue; }
        const std::string sibling = path.substr(prefix.size());
        if (sibling.find_first_of(".[") != std::string::npos) { continue; }
        const size_t distance = edit_distance(key, sibling);
        if (distance < best_distance) {
            best_distance = distance;
            best = sibling;
        }
    }
    return best;
}

void find_unknown(const config_file_t &c, const toml::table &table, const std::string &parent,
                  std::vector<std::string> &found)
{
    const std::string prefix = parent.empty() ? "" : parent + ".";
    for (const auto &[key, node] : table) {
        const std::string name(key.str());
        std::string path = prefix;
        path.append(name);
        if (c.allowed.count(path) != 0) { continue; }
        if (c.known.count(path) == 0) {
            const std::string hint = nearest(c, parent, name);
            found.push_back(place(c, node) + "unknown key '" + path + "'" +
                            (hint.empty() ? "" : " (did you mean '" + hint + "'?)"));
            continue;
        }
        if (const toml::table *inner = node.as_table()) { find_unknown(c, *inner, path, found); }
        if (const toml::array *array = node.as_array()) {
            for (size_t i = 0; i < array->size(); i++) {
                const toml::table *inner = array->get(i)->as_table();
                if (inner == nullptr) { continue; }
                std::string element = path;
                element.append("[").append(std::to_string(i)).append("]");
                find_unknown(c, *inner, element, found);
            }
        }
    }
}

/* The table that holds the last part of a dotted path, made where it is missing; `last` becomes that part. */
toml::table &holder(config_file_t &c, const std::string &path, std::string &last)
{
    toml::table *table = &c.root;
    size_t from = 0;
    for (size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', from)) {
        const std::string part = path.substr(from, dot - from);
        if (table->get_as<toml::table>(part) == nullptr) { table->insert_or_assign(part, toml::table{}); }
        table = table->get_as<toml::table>(part);
        from = dot + 1;
    }
    last = path.substr(from);
    return *table;
}

} /* namespace */

config_file_t *config_file_parse(const char *text, const char *name, char *why, size_t cap)
{
    auto *c = new config_file_t;
    c->name = name;
    try {
        c->root = toml::parse(std::string_view(text), std::string_view(name));
    } catch (const toml::parse_error &e) {
        const auto line = std::to_string(e.source().begin.line);
        put(why, cap, std::string(name) + ":" + line + ": " + std::string(e.description()));
        delete c;
        return nullptr;
    } catch (const std::logic_error &e) {
        put(why, cap, std::string(name) + ": " + e.what());
        delete c;
        return nullptr;
    }
    return c;
}

config_file_t *config_file_open(const char *path, bool *unreadable, char *why, size_t cap)
{
    const bool standard_input = std::strcmp(path, "-") == 0;
    std::FILE *f = standard_input ? stdin : std::fopen(path, "rb");
    std::string text;
    bool ok = f != nullptr;
    if (ok) {
        char block[4096];
        for (size_t n = std::fread(block, 1, sizeof block, f); n > 0; n = std::fread(block, 1, sizeof block, f)) {
            text.append(block, n);
        }
        ok = std::ferror(f) == 0;
        if (!standard_input) { std::fclose(f); }
    }
    if (unreadable != nullptr) { *unreadable = !ok; }
    if (!ok) {
        put(why, cap, std::string(path) + ": cannot be read");
        return nullptr;
    }
    return config_file_parse(text.c_str(), standard_input ? "standard input" : path, why, cap);
}

void config_file_close(config_file_t *c)
{
    delete c;
}

bool config_file_has(config_file_t *c, const char *path)
{
    return find(*c, path) != nullptr;
}

double config_file_number(config_file_t *c, const char *path, double fallback)
{
    const toml::node *node = find(*c, path);
    if (node == nullptr) { return fallback; }
    const double number = node->is_number() ? node->value<double>().value_or(NAN) : NAN;
    if (std::isfinite(number)) { return number; } /* TOML knows nan and inf; no setting of ours does */
    wrong_type(*c, path, *node, "a number");
    return fallback;
}

int64_t config_file_integer(config_file_t *c, const char *path, int64_t fallback)
{
    const toml::node *node = find(*c, path);
    if (node == nullptr) { return fallback; }
    if (node->is_integer()) { return node->value<int64_t>().value_or(fallback); }
    wrong_type(*c, path, *node, "a whole number");
    return fallback;
}

bool config_file_bool(config_file_t *c, const char *path, bool fallback)
{
    const toml::node *node = find(*c, path);
    if (node == nullptr) { return fallback; }
    if (node->is_boolean()) { return node->value<bool>().value_or(fallback); }
    wrong_type(*c, path, *node, "true or false");
    return fallback;
}

const char *config_file_string(config_file_t *c, const char *path, const char *fallback)
{
    const toml::node *node = find(*c, path);
    if (node == nullptr) { return fallback; }
    if (const auto *text = node->as_string()) { return text->get().c_str(); }
    wrong_type(*c, path, *node, "a string");
    return fallback;
}

int config_file_array_size(config_file_t *c, const char *path)
{
    const toml::node *node = find(*c, path);
    if (node == nullptr) { return 0; }
    if (const toml::array *array = node->as_array()) { return static_cast<int>(array->size()); }
    wrong_type(*c, path, *node, "an array");
    return 0;
}

bool config_file_numbers(config_file_t *c, const char *path, double *out, int n)
{
    const toml::node *node = find(*c, path);
    if (node == nullptr) { return false; }
    const toml::array *array = node->as_array();
    bool ok = array != nullptr && array->size() == static_cast<size_t>(n);
    for (int i = 0; ok && i < n; i++) {
        const toml::node *element = array->get(static_cast<size_t>(i));
        ok = element->is_number() && std::isfinite(element->value<double>().value_or(NAN));
    }
    if (!ok) {
        wrong_type(*c, path, *node, ("an array of " + std::to_string(n) + " numbers").c_str());
        return false;
    }
    for (int i = 0; i < n; i++) { out[i] = array->get(static_cast<size_t>(i))->value<double>().value_or(0.0); }
    return true;
}

const char *config_file_string_at(config_file_t *c, const char *path, int i, const char *fallback)
{
    const toml::node *node = find(*c, path);
    const toml::array *array = (node == nullptr) ? nullptr : node->as_array();
    if (array == nullptr || i < 0 || static_cast<size_t>(i) >= array->size()) { return fallback; }
    const toml::node *element = array->get(static_cast<size_t>(i));
    if (const auto *text = element->as_string()) { return text->get().c_str(); }
    wrong_type(*c, path, *node, "an array of strings");
    return fallback;
}

void config_file_allow(config_file_t *c, const char *path)
{
    make_known(*c, path);
    c->allowed.insert(path);
}

void config_file_complain(config_file_t *c, const char *path, const char *what)
{
    const toml::node *node = c->root.at_path(path).node();
    const std::string where = (node == nullptr) ? c->name + ": " : place(*c, *node);
    c->problems.push_back(where + "'" + path + "' " + what);
}

void config_file_set_number(config_file_t *c, const char *path, double value)
{
    std::string last;
    holder(*c, path, last).insert_or_assign(last, value);
}

void config_file_set_integer(config_file_t *c, const char *path, int64_t value)
{
    std::string last;
    holder(*c, path, last).insert_or_assign(last, value);
}

void config_file_set_numbers(config_file_t *c, const char *path, const double *value, int n)
{
    std::string last;
    toml::array array;
    for (int i = 0; i < n; i++) { array.push_back(value[i]); }
    holder(*c, path, last).insert_or_assign(last, std::move(array));
}

void config_file_set_string(config_file_t *c, const char *path, const char *value)
{
    std::string last;
    holder(*c, path, last).insert_or_assign(last, std::string(value));
}

size_t config_file_text(const config_file_t *c, const char *path, char *out, size_t cap)
{
    toml::table chosen;
    if (path[0] == '\0') {
        chosen = c->root;
    } else if (const toml::table *table = c->root.at_path(path).as_table()) {
        chosen.insert_or_assign(path, *table);
    }
    std::ostringstream text;
    text << chosen << '\n';
    put(out, cap, text.str());
    return std::min(text.str().size(), (cap > 0) ? cap - 1 : 0);
}

int config_file_check(const config_file_t *c, char *why, size_t cap)
{
    std::vector<std::string> all;
    find_unknown(*c, c->root, "", all);
    all.insert(all.end(), c->problems.begin(), c->problems.end());
    put(why, cap, all.empty() ? "" : all.front());
    return static_cast<int>(all.size());
}
