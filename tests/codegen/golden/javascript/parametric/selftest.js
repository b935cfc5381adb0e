// Compares planar_2r with the vectors; exits non-zero where one is missed.
import { readFileSync } from "node:fs";
import * as robot from "./planar_2r.js";

const folder = process.argv[2] ?? "vectors";
const parameters = [
  "m1",
  "m2",
  "l1",
  "lc1",
  "lc2",
  "I1",
  "I2",
  "g0",
  "l2",
];

function given(row, [name, at, size]) {
  const values = row.slice(at, at + size);
  return name === "params"
    ? Object.fromEntries(parameters.map((key, i) => [key, values[i]]))
    : Float64Array.from(values);
}

function test(name, compute, inputs, outputs, width) {
  const text = readFileSync(`${folder}/${name}.txt`, "utf8").trim();
  const rows = text.split("\n").map((line) => line.split(" ").map(Number));
  // units in the last place of the scale; infinite where a result is NaN
  let worst = 0;
  for (const row of rows) {
    const first = row === rows[0] && inputs.find(([key]) => key === "params");
    if (first && parameters.some((key, i) => robot.defaults[key] !== row[first[1] + i])) {
      worst = Infinity; // the first row holds the description's
    }
    if (row.length !== width) {
      throw new Error(`a row of ${name} is not as long as it should be`);
    }
    const result = compute(...inputs.map((input) => given(row, input)));
    for (const [key, at, size, scale] of outputs) {
      const one = outputs.length > 1 ? result[key] : result;
      const got = typeof one === "number" ? [one] : one;
      for (let i = 0; i < size; ++i) {
        const error = Math.abs(got[i] - row[at + i]) / (row[scale] * Number.EPSILON);
        worst = Number.isNaN(error) ? Infinity : Math.max(worst, error);
      }
    }
  }
  console.log(`${name}: ${rows.length} states, largest error ${worst.toPrecision(3)} ulp`);
  if (!(worst <= 32)) {
    process.exitCode = 1;
  }
}

test("dynamics", robot.dynamics, [["q", 0, 2], ["qdot", 2, 2], ["params", 4, 9]], [["M", 13, 4, 21], ["Cqdot", 17, 2, 22], ["g", 19, 2, 23]], 24);
test("inverse_dynamics", robot.inverseDynamics, [["q", 0, 2], ["qdot", 2, 2], ["qddot", 4, 2], ["params", 6, 9]], [["tau", 15, 2, 17]], 18);
