(* Of each body: its parent's number, its joint, the number of the coordinate that moves it and by
   how much, its pose in its parent's frame, its mass, its mass times its centre of mass, its
   inertia about the origin of its frame, and its armature. Body 0 is the ground. *)
bodies = <bodies>;
field = <field>;

turn[angle_] := {
  {Cos[angle], -Sin[angle], 0, 0},
  {Sin[angle], Cos[angle], 0, 0},
  {0, 0, 1, 0},
  {0, 0, 0, 1}}
slide[way_] := {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, way}, {0, 0, 0, 1}}

(* The derivative of joint[x] is joint[x] . twist[joint]. *)
twist[turn] = {{0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}};
twist[slide] = {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0, 0}};

(* A body's pose in its parent's frame, and the derivatives of its joint's position. *)
place[{_, joint_, coordinate_, factor_, seat_, ___}, q_] := seat . joint[factor*q[[coordinate]]]
share[{_, _, coordinate_, factor_, ___}] := factor*UnitVector[<n>, coordinate]

(* What each body has, from what its parent has: from the ground outwards. *)
outwards[next_, ground_] := Rest[Fold[
  Append[#1, next[#1[[First[#2] + 1]], #2]] &,
  {ground},
  bodies]]

(* A body's pose, and the derivatives of that by the coordinates, of which many are zero. *)
motion[{pose_, slopes_}, body_, q_] := With[
  {here = place[body, q], turned = pose . place[body, q] . twist[body[[2]]]},
  {pose . here, Map[carried[#, here] &, slopes] + Outer[Times, share[body], turned]}]

zero = ConstantArray[0, {4, 4}];
carried[zero, _] = zero;
carried[slope_, here_] := slope . here

(* And the second derivatives. *)
motion[{pose_, slopes_, curves_}, body_, q_] := With[
  {here = place[body, q], own = share[body], more = bent[pose, slopes, body, q]},
  Append[
    motion[{pose, slopes}, body, q],
    Table[
      carried[curves[[first, second]], here] +
        own[[first]]*more[[second]] + own[[second]]*more[[first]],
      {first, <n>}, {second, <n>}]]]

bent[pose_, slopes_, body_, q_] := With[
  {turned = place[body, q] . twist[body[[2]]]},
  Map[carried[#, turned] &, slopes] + Outer[Times, share[body]/2, pose . turned . twist[body[[2]]]]]

(* The slopes, weighed by a body's mass, first moments and second moments. *)
weighed[slopes_, {_, _, _, _, _, mass_, moment_, inertia_, _}] := With[
  {moments = Append[
     MapThread[Append, {Tr[inertia]/2*IdentityMatrix[3] - inertia, moment}],
     Append[moment, mass]]},
  Map[Flatten[carried[#, moments]] &, slopes]]

inertias[{_, slopes_}, body_] :=
  weighed[slopes, body] . Transpose[Map[Flatten, slopes]] +
    Last[body]*Outer[Times, share[body], share[body]]

symbols[{_, slopes_, curves_}, body_] := With[
  {flat = Map[Flatten, curves, {2}]},
  Map[flat . # &, weighed[slopes, body]]]

<kinetic_energy>[<q>, <qdot>] := With[
  {moved = outwards[motion[#1, #2, q] &, {IdentityMatrix[4], ConstantArray[0, {<n>, 4, 4}]}]},
  qdot . Total[MapThread[inertias, {moved, bodies}]] . qdot/2]

<potential_energy>[<q>] := With[
  {fields = outwards[#1 . place[#2, q] &, field]},
  -Total[MapThread[#1 . Append[#2[[7]], #2[[6]]] &, {fields, bodies}]]]

(* What D gives of T and P, in less time: by the derivatives of the poses. *)

<gravity_vector>[<q>] := With[
  {moved = outwards[motion[#1, #2, q] &, {IdentityMatrix[4], ConstantArray[0, {<n>, 4, 4}]}]},
  -Total[MapThread[Last[#1] . Append[#2[[7]], #2[[6]]] &, {moved, bodies}]] . field]

<christoffel>[<q>] := With[
  {moved = outwards[
     motion[#1, #2, q] &,
     {IdentityMatrix[4], ConstantArray[0, {<n>, 4, 4}], ConstantArray[0, {<n>, <n>, 4, 4}]}]},
  Total[MapThread[symbols, {moved, bodies}]]]
