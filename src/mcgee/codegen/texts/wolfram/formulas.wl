<kinetic_energy_of_each> := (
  <T>)

<potential_energy_of_each> := (
  <P>)

<gravity_vector>[<q>] := Module[
  {step},
  Table[
    D[<potential_energy>[ReplacePart[q, joint -> step]], step] /. step -> q[[joint]],
    {joint, <n>}]]

<christoffel>[<q>] := Module[
  {step},
  symbols[Table[
    D[<mass_matrix>[ReplacePart[q, joint -> step]], step] /. step -> q[[joint]],
    {joint, <n>}]]]

(* By slopes[[k, i, j]], which is dM_ij/dq_k. *)
symbols[slopes_] := Table[
  (slopes[[third, first, second]] + slopes[[second, first, third]]
    - slopes[[first, second, third]])/2,
  {first, <n>}, {second, <n>}, {third, <n>}]
