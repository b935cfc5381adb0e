(* Compares <package>.wl with the vectors, its functions and what it derives
   from T and P; exits with 1 where one is missed. *)

$IterationLimit = 10^9; (* in Mathics every look at a list counts *)

Get[FileNameJoin[{Directory[], "<package>.wl"}]];

rows[name_, width_] := With[
  {numbers = ReadList[FileNameJoin[{Directory[], "<vectors>", name <> ".txt"}], Real]},
  If[ListQ[numbers] && Mod[Length[numbers], width] == 0, Partition[N[numbers], width], {}]];

split[row_, sizes_] := With[
  {ends = Accumulate[sizes]},
  MapThread[Take[row, {#1, #2}] &, {ends - sizes + 1, ends}]];

(* In units in the last place of the scale; infinite where a result is no number. *)
error[got_, want_, scale_] := If[
  VectorQ[got, NumberQ] && Length[got] == Length[want],
  Max[Abs[got - want]]/(scale*2.^-52),
  Infinity];

worst[row_, inputs_, outputs_, function_] := Module[
  {arrays = split[row, Join[inputs, outputs]], scales = Take[row, -Length[outputs]], got},
  got = function @@ Take[arrays, Length[inputs]];
  If[Length[outputs] == 1, got = {got}];
  If[
    ListQ[got] && Length[got] == Length[outputs],
    Max[MapThread[error[Flatten[{#1}], #2, #3] &, {got, Drop[arrays, Length[inputs]], scales}]],
    Infinity]];

shown[number_] := If[
  NumberQ[number],
  With[
    {hundredths = Round[100*number]},
    StringJoin[
      ToString[Quotient[hundredths, 100]], ".",
      StringTake[ToString[100 + Mod[hundredths, 100]], -2]]],
  "inf"];

test[name_, how_, count_, inputs_, outputs_, function_, tolerance_] := Module[
  {states = rows[name, Total[inputs] + Total[outputs] + Length[outputs]], most},
  states = Take[states, -Min[count, Length[states]]];
  most = Max[Map[worst[#, inputs, outputs, function] &, states]];
  Print[name, how, ": ", Length[states], " states, largest error ", shown[most], " ulp"];
  Length[states] > 0 && TrueQ[most <= tolerance]];

(* The first row holds the parameters of the description. *)
standard[name_, inputs_, outputs_, values_] := Module[
  {states = rows[name, Total[inputs] + Total[outputs] + Length[outputs]], same},
  same = Length[states] > 0
    && TrueQ[Max[Abs[split[First[states], inputs][[-1]] - values] - 2.^-50*Abs[values]] <= 0];
  If[!same, Print["the parameters are not those of the vectors of ", name]];
  same];

passed = {
<tests>};

Exit[If[MatchQ[passed, {True ..}], 0, 1]];
