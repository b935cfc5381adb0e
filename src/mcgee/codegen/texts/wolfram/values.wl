(* The parameters' numbers: rules, or the numbers themselves. *)
values[params : {___Rule}] :=
  <names> /. params /. <parameters>
values[params_List] := params
