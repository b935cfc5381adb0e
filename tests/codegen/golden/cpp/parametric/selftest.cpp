// Compares planar_2r with the vectors; exits non-zero where one is missed.
#include "planar_2r.hpp"

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Row = std::vector<double>;

std::vector<Row> rows_of(const std::string& folder, const std::string& name, std::size_t width)
{
    const std::string path = folder + "/" + name + ".txt";
    std::ifstream file(path);
    std::vector<Row> rows;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        Row row;
        for (std::string word; words >> word;) {
            row.push_back(std::strtod(word.c_str(), nullptr));
        }
        if (row.size() != width) {
            std::fprintf(stderr, "a row of %s is not as long as it should be\n", path.c_str());
            std::exit(2);
        }
        rows.push_back(row);
    }
    if (rows.empty()) {
        std::fprintf(stderr, "cannot read %s\n", path.c_str());
        std::exit(2);
    }
    return rows;
}

template <typename Vector>
void read(Vector& to, const Row& row, std::size_t at)
{
    for (Eigen::Index i = 0; i < to.size(); ++i) {
        to[i] = static_cast<double>(row[at + static_cast<std::size_t>(i)]);
    }
}

// The largest error in units in the last place of the scale; infinite where a result is NaN.
void compare_one(double& worst, double got, double want, double scale)
{
    const double unit = scale*static_cast<double>(std::numeric_limits<double>::epsilon());
    const double error = std::abs(static_cast<double>(got) - want)/unit;
    if (!(error <= worst)) {
        worst = std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
    }
}

inline void compare(double& worst, double got, const Row& row, std::size_t at, std::size_t scale)
{
    compare_one(worst, got, row[at], row[scale]);
}

template <std::size_t N>
void compare(
    double& worst, const std::array<double, N>& got, const Row& row, std::size_t at,
    std::size_t scale)
{
    for (std::size_t i = 0; i < N; ++i) {
        compare_one(worst, got[i], row[at + i], row[scale]);
    }
}

template <typename Derived>
void compare(
    double& worst, const Eigen::MatrixBase<Derived>& got, const Row& row, std::size_t at,
    std::size_t scale)
{
    for (Eigen::Index i = 0; i < got.rows(); ++i) {
        for (Eigen::Index j = 0; j < got.cols(); ++j) {
            compare_one(worst, got(i, j), row[at++], row[scale]);
        }
    }
}

bool report(const char* name, std::size_t rows, double worst)
{
    std::printf("%s: %d states, largest error %.3g ulp\n", name, static_cast<int>(rows), worst);
    return !(worst <= 32);
}

bool test_dynamics(const std::string& folder)
{
    double worst = 0;
    const auto rows = rows_of(folder, "dynamics", 24);
    for (const auto& row : rows) {
        Eigen::Matrix<double, 2, 1> q;
        read(q, row, 0);
        Eigen::Matrix<double, 2, 1> qdot;
        read(qdot, row, 2);
        Planar2rParams params;
        params.m1 = static_cast<double>(row[4]);
        params.m2 = static_cast<double>(row[5]);
        params.l1 = static_cast<double>(row[6]);
        params.lc1 = static_cast<double>(row[7]);
        params.lc2 = static_cast<double>(row[8]);
        params.I1 = static_cast<double>(row[9]);
        params.I2 = static_cast<double>(row[10]);
        params.g0 = static_cast<double>(row[11]);
        params.l2 = static_cast<double>(row[12]);
        const Planar2rParams standard{};  // which the first row holds
        if (&row == &rows[0] && std::memcmp(&params, &standard, sizeof params) != 0) {
            worst = std::numeric_limits<double>::infinity();
        }
        Eigen::Matrix<double, 2, 2> M;
        Eigen::Matrix<double, 2, 1> Cqdot;
        Eigen::Matrix<double, 2, 1> g;
        planar_2r_dynamics(q, qdot, params, M, Cqdot, g);
        compare(worst, M, row, 13, 21);
        compare(worst, Cqdot, row, 17, 22);
        compare(worst, g, row, 19, 23);
    }
    return report("dynamics", rows.size(), worst);
}

bool test_inverse_dynamics(const std::string& folder)
{
    double worst = 0;
    const auto rows = rows_of(folder, "inverse_dynamics", 18);
    for (const auto& row : rows) {
        Eigen::Matrix<double, 2, 1> q;
        read(q, row, 0);
        Eigen::Matrix<double, 2, 1> qdot;
        read(qdot, row, 2);
        Eigen::Matrix<double, 2, 1> qddot;
        read(qddot, row, 4);
        Planar2rParams params;
        params.m1 = static_cast<double>(row[6]);
        params.m2 = static_cast<double>(row[7]);
        params.l1 = static_cast<double>(row[8]);
        params.lc1 = static_cast<double>(row[9]);
        params.lc2 = static_cast<double>(row[10]);
        params.I1 = static_cast<double>(row[11]);
        params.I2 = static_cast<double>(row[12]);
        params.g0 = static_cast<double>(row[13]);
        params.l2 = static_cast<double>(row[14]);
        const Planar2rParams standard{};  // which the first row holds
        if (&row == &rows[0] && std::memcmp(&params, &standard, sizeof params) != 0) {
            worst = std::numeric_limits<double>::infinity();
        }
        Eigen::Matrix<double, 2, 1> tau;
        planar_2r_inverse_dynamics(q, qdot, qddot, params, tau);
        compare(worst, tau, row, 15, 17);
    }
    return report("inverse_dynamics", rows.size(), worst);
}

}  // namespace

int main(int count, char** words)
{
    const std::string folder = count > 1 ? words[1] : "vectors";
    bool failed = false;
    failed |= test_dynamics(folder);
    failed |= test_inverse_dynamics(folder);
    return failed ? 1 : 0;
}
