import type { Page } from "../app/page";
import { withFront, withUp } from "../app/upright";
import { Menu } from "./ui/menu";

/** The menu at the view cube: how the model stands. It is remembered for each model. */
export function CubeMenu({ page }: { page: Page }) {
  const { view } = page.editor;
  const { viewport } = page;
  const show = () => {
    viewport.lookFrom("front");
    viewport.fit();
  };
  const turn = (how: typeof withFront) => {
    view.stand(how(viewport.navigation.upright, viewport.sideSeen()));
    show();
  };
  const isAsInFile = view.up.value === "auto" && view.front.value === undefined;
  return (
    <Menu
      label="How the model stands"
      items={[
        { label: "This side is the front", icon: "model", run: () => turn(withFront) },
        { label: "This side is up", icon: "up", run: () => turn(withUp) },
        {
          label: "As in the file",
          icon: "reset",
          disabled: isAsInFile,
          begins: true,
          run: () => {
            view.standAsInFile();
            show();
          },
        },
      ]}
    />
  );
}
