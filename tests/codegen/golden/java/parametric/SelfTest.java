/** Compares Planar2rDynamics with the vectors; exits non-zero where one is missed. */
import java.io.IOException;
import java.nio.charset.StandardCharsets;
import java.nio.file.Files;
import java.nio.file.Paths;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.Locale;

public final class SelfTest {
    private SelfTest() {
    }

    private static List<double[]> rows(String folder, String name, int width) throws IOException {
        final List<double[]> rows = new ArrayList<>();
        for (String line : Files.readAllLines(
                Paths.get(folder, name + ".txt"), StandardCharsets.US_ASCII)) {
            final double[] row =
                Arrays.stream(line.split(" ")).mapToDouble(Double::parseDouble).toArray();
            if (row.length != width) {
                throw new IOException("a row of " + name + " is not as long as it should be");
            }
            rows.add(row);
        }
        return rows;
    }

    private static double[] flat(Object array) {
        if (array instanceof Double) {
            return new double[] {(Double) array};
        }
        if (array instanceof double[]) {
            return (double[]) array;
        }
        return Arrays.stream((Object[]) array)
            .flatMapToDouble(x -> Arrays.stream(flat(x))).toArray();
    }

    /** The largest error in units in the last place of the scale; infinite where one is NaN. */
    private static double worse(double worst, double[] got, double[] row, int at, double scale) {
        for (int i = 0; i < got.length; ++i) {
            final double error = Math.abs(got[i] - row[at + i])/(scale*Math.ulp(1.0));
            worst = Double.isNaN(error) ? Double.POSITIVE_INFINITY : Math.max(worst, error);
        }
        return worst;
    }

    private static boolean report(String name, int rows, double worst) {
        System.out.println(String.format(
            Locale.ROOT, "%s: %d states, largest error %.3g ulp", name, rows, worst));
        return !(rows > 0 && worst <= 32);
    }

    private static boolean dynamics(String folder) throws IOException {
        double worst = 0;
        final List<double[]> rows = rows(folder, "dynamics", 24);
        for (double[] row : rows) {
            final double[] q = Arrays.copyOfRange(row, 0, 2);
            final double[] qdot = Arrays.copyOfRange(row, 2, 4);
            final Planar2rDynamics.Params params = new Planar2rDynamics.Params();
            worst = row == rows.get(0) && params.m1 != row[4] ? Double.POSITIVE_INFINITY : worst;
            params.m1 = row[4];
            worst = row == rows.get(0) && params.m2 != row[5] ? Double.POSITIVE_INFINITY : worst;
            params.m2 = row[5];
            worst = row == rows.get(0) && params.l1 != row[6] ? Double.POSITIVE_INFINITY : worst;
            params.l1 = row[6];
            worst = row == rows.get(0) && params.lc1 != row[7] ? Double.POSITIVE_INFINITY : worst;
            params.lc1 = row[7];
            worst = row == rows.get(0) && params.lc2 != row[8] ? Double.POSITIVE_INFINITY : worst;
            params.lc2 = row[8];
            worst = row == rows.get(0) && params.I1 != row[9] ? Double.POSITIVE_INFINITY : worst;
            params.I1 = row[9];
            worst = row == rows.get(0) && params.I2 != row[10] ? Double.POSITIVE_INFINITY : worst;
            params.I2 = row[10];
            worst = row == rows.get(0) && params.g0 != row[11] ? Double.POSITIVE_INFINITY : worst;
            params.g0 = row[11];
            worst = row == rows.get(0) && params.l2 != row[12] ? Double.POSITIVE_INFINITY : worst;
            params.l2 = row[12];
            final Planar2rDynamics.Result result = Planar2rDynamics.compute(q, qdot, params);
            worst = worse(worst, flat(result.M), row, 13, row[21]);
            worst = worse(worst, flat(result.Cqdot), row, 17, row[22]);
            worst = worse(worst, flat(result.g), row, 19, row[23]);
        }
        return report("dynamics", rows.size(), worst);
    }

    private static boolean inverseDynamics(String folder) throws IOException {
        double worst = 0;
        final List<double[]> rows = rows(folder, "inverse_dynamics", 18);
        for (double[] row : rows) {
            final double[] q = Arrays.copyOfRange(row, 0, 2);
            final double[] qdot = Arrays.copyOfRange(row, 2, 4);
            final double[] qddot = Arrays.copyOfRange(row, 4, 6);
            final Planar2rDynamics.Params params = new Planar2rDynamics.Params();
            worst = row == rows.get(0) && params.m1 != row[6] ? Double.POSITIVE_INFINITY : worst;
            params.m1 = row[6];
            worst = row == rows.get(0) && params.m2 != row[7] ? Double.POSITIVE_INFINITY : worst;
            params.m2 = row[7];
            worst = row == rows.get(0) && params.l1 != row[8] ? Double.POSITIVE_INFINITY : worst;
            params.l1 = row[8];
            worst = row == rows.get(0) && params.lc1 != row[9] ? Double.POSITIVE_INFINITY : worst;
            params.lc1 = row[9];
            worst = row == rows.get(0) && params.lc2 != row[10] ? Double.POSITIVE_INFINITY : worst;
            params.lc2 = row[10];
            worst = row == rows.get(0) && params.I1 != row[11] ? Double.POSITIVE_INFINITY : worst;
            params.I1 = row[11];
            worst = row == rows.get(0) && params.I2 != row[12] ? Double.POSITIVE_INFINITY : worst;
            params.I2 = row[12];
            worst = row == rows.get(0) && params.g0 != row[13] ? Double.POSITIVE_INFINITY : worst;
            params.g0 = row[13];
            worst = row == rows.get(0) && params.l2 != row[14] ? Double.POSITIVE_INFINITY : worst;
            params.l2 = row[14];
            final Object result = Planar2rDynamics.inverseDynamics(q, qdot, qddot, params);
            worst = worse(worst, flat(result), row, 15, row[17]);
        }
        return report("inverse_dynamics", rows.size(), worst);
    }

    public static void main(String[] words) throws IOException {
        final String folder = words.length > 0 ? words[0] : "vectors";
        boolean failed = false;
        failed |= dynamics(folder);
        failed |= inverseDynamics(folder);
        System.exit(failed ? 1 : 0);
    }
}
