rates = <rates>;

<mass_matrix>[<q>] := With[
  {energy = <kinetic_energy>[q, rates]},
  Outer[D, Map[D[energy, #] &, rates], rates]]

<coriolis_matrix>[<q>, <qdot>] :=
  <christoffel>[q] . qdot

<coriolis_forces>[<q>, <qdot>] :=
  <coriolis_matrix>[q, qdot] . qdot
