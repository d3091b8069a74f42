/* The widget of a table being learned: how many rows are shown is told to Python, and the other way round. */
function render({ model, el }) {
  const root = document.createElement("div");
  el.append(root);
  const go = learningView(root, model.get("_data"), (n) => {
    model.set("n", n);
    model.save_changes();
  });
  const follow = () => go(model.get("n"));
  model.on("change:n", follow);
  follow();
  return () => model.off("change:n", follow);
}

export default { render };
